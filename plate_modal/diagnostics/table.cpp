// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {

/// Makes a diagnostic; nullptr where it does not apply. `motion` is nullptr in a static or modal analysis.
using Make = std::shared_ptr<diagnostics::Diagnostic>(const PlateView&,
                                                      const std::shared_ptr<Motion>& motion);
Make balance_of_energies, step_size, prescribed_pressures, impact_on_seat, plate_theory, truncated_modes,
    mesh_of_modes, step_error;

namespace {

struct TableRow {
  const char* name;
  Make* make;
  bool estimates = false;  ///< an error: not where estimates are switched off
};

// "step-size" adds each step to the motion, which others read; "prescribed-pressures" adds its part to the mesh error.
constexpr std::array table_rows{TableRow{"balance-of-energies", balance_of_energies},
                                TableRow{"step-size", step_size},
                                TableRow{"impact-on-seat", impact_on_seat},
                                TableRow{"plate-theory", plate_theory},
                                TableRow{"truncated-modes", truncated_modes},
                                TableRow{"mesh-of-modes", mesh_of_modes},
                                TableRow{"prescribed-pressures", prescribed_pressures},
                                TableRow{"step-error", step_error, true}};

}  // namespace

void add_diagnostics(const PlateView& view, diagnostics::Diagnostics& all) {
  const auto motion = view.is_dynamic() ? std::make_shared<Motion>(view.surface.omega()) : nullptr;
  for (const TableRow& row : table_rows)
    if (auto one = row.estimates && !all.with_errors() ? nullptr : row.make(view, motion))
      all.add(row.name, std::move(one));
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

void report_neglected(diagnostics::Report& report, const char* effect, double number, double limit,
                      std::string what, std::string advice, double share) {
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
