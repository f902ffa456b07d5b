// SPDX-License-Identifier: Apache-2.0
// Checks that the time step resolves the moving modes, and estimates its error.
#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "common/io/checkpoint.hpp"
#include "common/time/step_errors.hpp"
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

/// With ten steps per period the trapezoidal rule lengthens the period by 3 %, and a mode at a wrong
/// frequency responds to a load like another structure.
class StepSize final : public diagnostics::Diagnostic {
 public:
  StepSize(const PlateView& view, std::shared_ptr<Motion> motion) : view_(view), motion_(std::move(motion)) {}
  void observe(diagnostics::Report&) override {
    motion_->accepted(view_.before, view_.state, view_.oscillators.load(), view_.step.dt);
  }
  void look(diagnostics::Report& report) override {
    const Motion::Evidence seen = motion_->evidence(view_.step.is_last);
    const bool is_coarse = seen.coarse_share > 0;
    report_present(
        report, "step that resolves the modes", seen.coarse_share, Motion::coarse_limit,
        is_coarse ? fmt::format("modes with fewer than ten steps per period (first: mode {}, {:.2g} steps) "
                                "make up {:.2g} of the displacement (rms)",
                                seen.coarse_mode, seen.steps_a_period, seen.coarse_share)
                  : "no oscillating mode has fewer than ten steps per period",
        is_coarse ? fmt::format("they oscillate at a wrong frequency: use 'simulation.time-step: "
                                "{:.2g} s'",
                                seen.recommended_step)
                  : "");
    report_present(report, "step near a resonance", seen.resonance_error, 0.1,
                   fmt::format("mode {} is near resonance (amplification {:.2g}): displacement error by the "
                               "step's frequency error = {:.2g}",
                               seen.resonant_mode, seen.amplification, seen.resonance_error),
                   fmt::format("use 'simulation.time-step: {:.2g} s'", seen.resonant_step));
  }
  void visit(io::Archive& archive) override { archive.common("motion", *motion_); }

 private:
  PlateView view_;
  std::shared_ptr<Motion> motion_;
};

double norm_of(std::span<const double> amplitudes) {
  return std::sqrt(std::inner_product(amplitudes.begin(), amplitudes.end(), amplitudes.begin(), 0.0));
}

/// Error of all steps so far, for modes of unit mass.
class StepError final : public diagnostics::Diagnostic {
 public:
  explicit StepError(const PlateView& view) : view_(view), errors_(view.parameters.time_scheme) {}
  void observe(diagnostics::Report&) override {
    const ModalState &before = view_.before, &now = view_.state;
    errors_.add(before.v, now.v, now.dt, before.dt, norm_of(now.q), norm_of, rate_of_decay());
  }
  void conclude(diagnostics::Report& report) override { report.errors.step = errors_.over_size(); }
  void visit(io::Archive& archive) override {
    std::vector<double> state = errors_.state();
    archive.common("errors", state);
    if (archive.reads()) errors_.restore(state);
  }

 private:
  /// Decay rate of the present motion by damping [1/s].
  double rate_of_decay() const {
    const std::span<const double> c = view_.oscillators.damping();
    const std::vector<double>&omega = view_.surface.omega(), &v = view_.state.v;
    double lost = 0, all = 0;
    for (std::size_t m = 0; m < c.size(); ++m) {
      // Above critical damping, the slower of two rates.
      lost += v[m] * v[m] * (c[m] <= 2 * omega[m] ? 0.5 * c[m] : omega[m] * omega[m] / c[m]);
      all += v[m] * v[m];
    }
    return all > 0 ? lost / all : 0;
  }

  PlateView view_;
  time::VelocityErrors errors_;
};

}  // namespace

diagnostics::Made step_size(const PlateView& view, const std::shared_ptr<Motion>& motion) {
  return motion ? std::make_shared<StepSize>(view, motion) : nullptr;
}

diagnostics::Made step_error(const PlateView& view, const std::shared_ptr<Motion>& motion) {
  return motion ? std::make_shared<StepError>(view) : nullptr;
}

}  // namespace couplet::plate
