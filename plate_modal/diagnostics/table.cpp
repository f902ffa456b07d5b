// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {

// `motion` is nullptr in a static or modal analysis.
#define FINDING(about, id, meaning)
#define ESTIMATE(name, make) diagnostics::Made make(const PlateView&, const std::shared_ptr<Motion>& motion);
#define DIAGNOSTIC ESTIMATE
#include "plate_modal/diagnostics/table.def"
#undef DIAGNOSTIC
#undef ESTIMATE

void add_diagnostics(const PlateView& view, diagnostics::Diagnostics& all) {
  const auto motion = view.is_dynamic() ? std::make_shared<Motion>(view.surface.omega()) : nullptr;
#define DIAGNOSTIC(name, make) all.add(name, make(view, motion));
#define ESTIMATE(name, make) \
  if (all.with_errors()) all.add(name, make(view, motion));
#include "plate_modal/diagnostics/table.def"
#undef DIAGNOSTIC
#undef ESTIMATE
#undef FINDING
}

double PlateView::first_elastic() const {
  for (const double omega : surface.omega())
    if (omega > 0) return omega * omega;
  return 1;
}

std::size_t PlateView::n_cells() const {
  std::size_t faces = 0;  // the rims of a plate stand for no mass
  for (const double density : model().face_density) faces += density > 0;
  return parameters.wetted == Wetted::both ? faces / 2 : faces;
}

std::optional<double> time_to_look(const PlateView& view) {
  const coupling::Step& step = view.step;
  if (!view.is_dynamic()) {
    if (step.number > 0 && view.state.q == view.before.q) return {};
    return step.time + step.dt;
  }
  const GlobalIndex steps = step.number + 1;
  const bool is_power_of_two = (steps & (steps - 1)) == 0;
  if (!(steps <= 8 || is_power_of_two || step.is_last)) return {};
  return step.time + 0.5 * step.dt;
}

void report_neglected(diagnostics::Report& report, const char* effect, double number, std::string what,
                      std::string advice, double share, double limit) {
  if (auto finding = diagnostics::finding_of({.effect = effect,
                                              .number = number,
                                              .limit = limit,
                                              .what = std::move(what),
                                              .advice = std::move(advice),
                                              .share = share}))
    report.findings.push_back(std::move(*finding));
}

void report_present(diagnostics::Report& report, const char* effect, double number, double limit,
                    std::string what, std::string advice, double wrong_from) {
  if (auto finding = diagnostics::finding_of({.effect = effect,
                                              .number = number,
                                              .limit = limit,
                                              .what = std::move(what),
                                              .advice = std::move(advice),
                                              .left_out = false,
                                              .wrong_from = wrong_from}))
    report.findings.push_back(std::move(*finding));
}

}  // namespace couplet::plate
