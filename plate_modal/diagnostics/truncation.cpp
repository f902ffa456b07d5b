// SPDX-License-Identifier: Apache-2.0
// Estimates the contribution of the truncated modes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/mesh/load.hpp"
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

/// Judges the truncation of modes in a dynamic analysis by static correction: compliance f (K + s M)^-1 f of
/// the plate relative to that of its modes, sum (phi . f)^2/(omega^2 + s), summed over sampled times. s is 0
/// for a held plate, otherwise the square of its first nonzero frequency.
class TruncatedModes final : public diagnostics::Diagnostic {
 public:
  TruncatedModes(const PlateView& view, std::shared_ptr<const Motion> motion)
      : view_(view),
        motion_(std::move(motion)),
        shift_(view.surface.omega().front() == 0 ? view.first_elastic() : 0) {}
  void observe(diagnostics::Report&) override {
    if (!motion_ || view_.parameters.modes_file) return;
    const auto t = time_to_look(view_);
    if (!t) return;
    std::vector<double> sums{left_out_, all_};
    mesh::on_root(view_.comm, [&] { add_compliance(*t, sums); });
    mesh::broadcast(view_.comm, sums);
    left_out_ = sums[0], all_ = sums[1];
  }
  void look(diagnostics::Report& report) override {
    if (!motion_) return look_at_deflection(report);
    const double share = all_ > 0 ? left_out_ / all_ : unknown;
    report_neglected(report, "deflection beyond the modes", share,
                     fmt::format("compliance of the loads in truncated modes = {:.2g}", share),
                     "the loads excite truncated modes: keep more modes ('modes.number')", share);
    // A load without a component in the truncated modes does not excite them at any frequency.
    if (!(share < 1e-6)) look_at_load_frequency(report, share);
    look_at_velocity(report);
  }
  void visit(io::Archive& archive) override { archive.common("compliance", left_out_, all_); }

 private:
  void add_compliance(double t, std::vector<double>& sums) {
    std::vector<double> pressure;
    try {
      pressure = cell_pressures(*view_.built.plate, view_.parameters, view_.pressure, view_.fluid_force, t);
    } catch (const Error&) {
      return;  // no value there: the scheme need not ask for it
    }
    const PlateModel& plate = *view_.built.plate;
    const Vec3 normal = view_.parameters.placement.normal();
    const std::vector<double> areas = plate.cell_areas();
    const std::vector<double> load = plate.load_of(pressure);
    if (std::ranges::all_of(load, [](double f) { return f == 0; })) return;
    if (!solver_) {
      matrix_.emplace(plate.shifted_stiffness(shift_));
      solver_ = std::make_unique<linalg::LinearSolver>(
          "deflection beyond the modes", *matrix_,
          linalg::LinearOptions{.method = linalg::LinearMethod::direct_symmetric});
    }
    std::vector<double> u(load.size(), 0);
    solver_->solve(load, u);
    double all = 0, kept = 0;
    for (std::size_t i = 0; i < u.size(); ++i) all += load[i] * u[i];
    const std::vector<double>&omega = view_.surface.omega(), &shape = view_.model().face_shape;
    const std::size_t n = omega.size();
    for (std::size_t m = 0; m < n; ++m) {
      double on_mode = 0;
      for (std::size_t c = 0; c < pressure.size(); ++c) {
        const double* mean = shape.data() + 3 * c * n + m;
        on_mode += pressure[c] * areas[c] * Vec3(mean[0], mean[n], mean[2 * n]).dot(normal);
      }
      kept += on_mode * on_mode / (omega[m] * omega[m] + shift_);
    }
    sums[0] += std::max(0.0, all - kept);
    sums[1] += all;
  }
  /// In a static analysis the deflection itself is known.
  void look_at_deflection(diagnostics::Report& report) const {
    const auto& d = view_.deflection;
    const double apart = d && d->direct > 0 ? d->apart / d->direct : unknown;
    report_neglected(
        report, "deflection beyond the modes", apart,
        fmt::format("truncation error of the deflection = {:.2g}", apart),
        "fields and probes show the full deflection, but modal.csv and the interface only the modes: keep "
        "more modes ('modes.number')",
        apart);
  }
  // A mode responds to a load of frequency f by 1/(1 - (f/f_mode)^2): at two thirds of its frequency 1.8
  // times the static measure, and near it without bound.
  void look_at_load_frequency(diagnostics::Report& report, double share) const {
    const Motion::LoadFrequency seen = motion_->load_frequency(view_.step.is_last);
    report_neglected(
        report, "load faster than the modes", seen.over_last,
        fmt::format("load frequency {:.3g} Hz = {:.2g} of the highest retained mode's",
                    seen.omega / (2 * std::numbers::pi), seen.over_last),
        "truncated modes may resonate: keep modes up to 1.5 times that frequency ('modes.number')",
        seen.over_last < 1 ? std::min(1., share / (1 / (seen.over_last * seen.over_last) - 1)) : 1, 2. / 3,
        "deflection-beyond-the-modes");
  }
  /// Share of the initial kinetic energy that is in no mode.
  void look_at_velocity(diagnostics::Report& report) const {
    const Vec3& v = view_.parameters.initial_velocity;
    if (!(v.norm() > 0)) return;
    double kept = 0;
    for (const double one : view_.surface.participation(v)) kept += one * one;
    const double lost = std::max(0.0, 1 - kept / (view_.model().mass * v.squaredNorm()));
    report_neglected(
        report, "initial velocity beyond the modes", lost,
        fmt::format("initial kinetic energy outside the modes = {:.2g}", lost),
        "a uniform velocity near supports needs many modes: keep more, or use 'initial-amplitudes'",
        0.5 * lost, 0, "deflection-beyond-the-modes");  // half that of an energy
  }

  PlateView view_;
  std::shared_ptr<const Motion> motion_;
  double shift_;                   // s [1/s^2]
  double left_out_ = 0, all_ = 0;  // compliance
  // On rank 0, created with the first load.
  std::optional<linalg::SparseMatrix> matrix_;
  std::unique_ptr<linalg::LinearSolver> solver_;
};

}  // namespace

diagnostics::Made truncated_modes(const RunOfPlate& run) {
  return std::make_shared<TruncatedModes>(run.view, run.motion);
}

}  // namespace couplet::plate
