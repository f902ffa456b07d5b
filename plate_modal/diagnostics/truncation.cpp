// SPDX-License-Identifier: Apache-2.0
// Estimates the contribution of the truncated modes.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

/// Judges the truncation of modes: in a static analysis by the deflection, in a dynamic one by the frequency of the load
/// and by the energy of the initial velocity. The part of other dynamic loads in truncated modes is not estimated.
class TruncatedModes final : public diagnostics::Diagnostic {
 public:
  TruncatedModes(const PlateView& view, std::shared_ptr<const Motion> motion)
      : view_(view), motion_(std::move(motion)) {}
  void look(diagnostics::Report& report) override {
    if (!motion_) return check_deflection(report);
    check_load_frequency(report);
    check_velocity(report);
  }
  void conclude(diagnostics::Report& report) override {
    if (motion_ && !view_.parameters.modes_file)
      report.sentences.emplace_back(
          "truncated modes: their contribution under these loads is not estimated; compare with more modes ('modes.number').");
  }

 private:
  /// In a static analysis the deflection itself is known.
  void check_deflection(diagnostics::Report& report) const {
    const auto& d = view_.deflection;
    const double apart = d && d->direct > 0 ? d->apart / d->direct : unknown;
    report_neglected(
        report, "deflection beyond the modes", apart,
        fmt::format("truncation error of the deflection = {:.2g}", apart),
        "fields and probes show the full deflection, but modal.csv and the interface show only that of the modes: keep more "
        "modes ('modes.number')",
        apart);
  }
  // A mode responds to a load of frequency f by 1/(1 - (f/f_mode)^2): at two thirds of its frequency 1.8
  // times the static measure, and near it without bound. How much of the load is in truncated modes is unknown.
  void check_load_frequency(diagnostics::Report& report) const {
    const Motion::LoadFrequency seen = motion_->load_frequency(view_.step.is_last);
    report_neglected(
        report, "load faster than the modes", seen.over_last,
        fmt::format("load frequency {:.3g} Hz = {:.2g} times that of the highest retained mode",
                    seen.omega / (2 * std::numbers::pi), seen.over_last),
        "truncated modes may resonate: keep modes up to 1.5 times that frequency ('modes.number')", unknown,
        2. / 3, "deflection-beyond-the-modes");
  }
  /// Share of the initial kinetic energy that is in no mode.
  void check_velocity(diagnostics::Report& report) const {
    const Vec3& v = view_.parameters.initial_velocity;
    if (!(v.norm() > 0)) return;
    double kept = 0;
    for (const double one : view_.surface.participation(v)) kept += one * one;
    const double lost = std::max(0.0, 1 - kept / (view_.model().mass * v.squaredNorm()));
    report_neglected(
        report, "initial velocity beyond the modes", lost,
        fmt::format("initial kinetic energy outside the modes = {:.2g}", lost),
        "a uniform velocity near supports needs many modes: keep more of them, or use 'initial-amplitudes'",
        0.5 * lost, 0, "deflection-beyond-the-modes");  // half that of an energy
  }

  PlateView view_;
  std::shared_ptr<const Motion> motion_;
};

}  // namespace

diagnostics::Made truncated_modes(const RunOfPlate& run) {
  return std::make_shared<TruncatedModes>(run.view, run.motion);
}

}  // namespace couplet::plate
