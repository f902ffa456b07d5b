// SPDX-License-Identifier: Apache-2.0
// The local error of a step, and the step size that follows from it.
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {
namespace {

// The next step aims below the tolerance by this factor, so that few steps are refused.
constexpr double safety = 0.85;

// The errors of several steps add up before damping and dissipation forget them.
constexpr double share_of_a_step = 0.1;

}  // namespace

// Error of a step: constant dt^3 d3u/dt3 (Euler: constant dt^2 d2u/dt2), with d3u/dt3 from the mean
// accelerations of this step and the last one. A coupled step is not refused here: its iterates come before
// the load has settled.
void SolidStepper::judge_step() {
  const time::LocalError local = time::local_error(scheme_of(parameters_));
  const double dt = step_.dt, apart = 0.5 * (dt + state_.dt);
  double error = 0, volume = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double v = geometry_.volume[c];
    for (int a = 0; a < mesh_.dim; ++a) {
      const std::size_t i = std::size_t(c) * mesh_.dim + a;
      const double derivative = local.order == 1
                                    ? trial_.mean_acceleration[i]
                                    : (trial_.mean_acceleration[i] - state_.mean_acceleration[i]) / apart;
      error += v * derivative * derivative;
    }
    volume += v;
  }
  volume = parallel::sum(mesh_.comm, volume);
  trial_.error =
      local.constant * std::pow(dt, local.order + 1) * std::sqrt(parallel::sum(mesh_.comm, error) / volume);
  if (step_.scheme != coupling::Scheme::standalone) return;
  const double tolerance = share_of_a_step * parameters_.step_control->tolerance;
  if (trial_.error > tolerance)
    throw SolveFailure("The estimated step error, {:.2g} m, exceeds a tenth of the tolerance, {:g} m.",
                       trial_.error, tolerance);
}

double SolidStepper::suggest_dt() const {
  if (!(state_.error > 0)) return std::numeric_limits<double>::infinity();
  const double room = share_of_a_step * parameters_.step_control->tolerance / state_.error;
  return safety * state_.dt * std::pow(room, 1. / (time::local_error(scheme_of(parameters_)).order + 1));
}

}  // namespace couplet::solid
