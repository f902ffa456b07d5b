// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {

namespace {

using diagnostics::When;
using PlateRow = diagnostics::TableRow<RunOfPlate>;

// "motion" adds each step to the motion, which others read; "prescribed-pressures" adds its part to the mesh error.
constexpr std::array table{PlateRow{"balance-of-energies", When::always, balance_of_energies},
                           PlateRow{"motion", When::always, motion_of_modes},
                           PlateRow{"impact-on-seat", When::always, impact_on_seat},
                           PlateRow{"plate-theory", When::always, plate_theory},
                           PlateRow{"truncated-modes", When::always, truncated_modes},
                           PlateRow{"mesh-of-modes", When::always, mesh_of_modes},
                           PlateRow{"prescribed-pressures", When::always, prescribed_pressures},
                           PlateRow{"step-error", When::with_errors, step_error}};

}  // namespace

void add_diagnostics(const PlateView& view, diagnostics::Diagnostics& all) {
  const auto motion = view.is_dynamic() ? std::make_shared<Motion>(view.surface.omega()) : nullptr;
  all.add(std::span<const PlateRow>(table), {view, motion});
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

std::optional<double> sample_time(const PlateView& view) {
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
                      std::string advice, double share, double limit, const char* id) {
  if (auto finding = diagnostics::finding_of({.effect = effect,
                                              .id = id,
                                              .number = number,
                                              .limit = limit,
                                              .what = std::move(what),
                                              .advice = std::move(advice),
                                              .share = share}))
    report.findings.push_back(std::move(*finding));
}

void report_present(diagnostics::Report& report, const char* effect, double number, double limit,
                    std::string what, std::string advice, double wrong_from, const char* id) {
  if (auto finding = diagnostics::finding_of({.effect = effect,
                                              .id = id,
                                              .number = number,
                                              .limit = limit,
                                              .what = std::move(what),
                                              .advice = std::move(advice),
                                              .left_out = false,
                                              .wrong_from = wrong_from}))
    report.findings.push_back(std::move(*finding));
}

}  // namespace couplet::plate
