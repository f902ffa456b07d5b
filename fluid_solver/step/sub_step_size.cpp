// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/sub_step_size.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::fluid {
namespace {

constexpr int most_sub_steps = 100000;
// The implicit viscous term costs about this much more a sub-step.
constexpr double implicit_cost = 1.5;

double parts(double dt, double limit) {
  return std::isfinite(limit) ? std::max(1.0, std::ceil(dt / limit - 1e-9)) : 1.0;
}

}  // namespace

template <int D>
SubStepSize<D>::SubStepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                            const FluidParameters& parameters)
    : parameters_(parameters), size_(mesh, boundary, parameters.kinematic_viscosity(), parameters.scheme) {}

template <int D>
void SubStepSize<D>::begin_step(const State<D>& level, double time, double dt, double frame_rate,
                                History<D>& begin) {
  time_ = time;
  dt_ = dt;
  size_.set_frame_rate(frame_rate);
  if (!parameters_.time_step) limits_ = size_.limits(level);
  if (parameters_.viscous == ViscousTreatment::automatic) choose_viscous_treatment(level, begin);
}

// With a step of its own the fluid keeps it whatever the treatment: implicit if the explicit one would not be
// stable. Else the cheaper one; a change starts the multi-step schemes anew, so it needs a clear gain.
template <int D>
void SubStepSize<D>::choose_viscous_treatment(const State<D>& level, History<D>& begin) {
  bool implicit = begin.implicit;
  if (parameters_.time_step) {
    const double own = dt_ / parts(dt_, *parameters_.time_step);
    implicit = size_.explicit_viscous_limit_is_below(own * (implicit ? 1.3 : 1.0) / parameters_.safety_factor,
                                                     level);
  } else {
    const double with_explicit = parts(dt_, parameters_.safety_factor * limits_.explicit_viscous);
    const double with_implicit =
        implicit_cost * parts(dt_, parameters_.safety_factor * implicit_limit(limits_));
    if (implicit && with_explicit < 0.7 * with_implicit) implicit = false;
    if (!implicit && with_implicit < 0.9 * with_explicit) implicit = true;
  }
  if (implicit == begin.implicit) return;
  begin.implicit = implicit;
  begin.dt_old = 0;
}

/// Limit by stability, and by accuracy where the case asks for it.
template <int D>
double SubStepSize<D>::implicit_limit(const StepLimits& limits) const {
  if (!parameters_.implicit_stretch) return limits.implicit_viscous;
  return std::min(limits.implicit_viscous, *parameters_.implicit_stretch * limits.explicit_viscous);
}

template <int D>
double SubStepSize<D>::next(const State<D>& level, bool implicit, int done, double remaining, bool& last) {
  double limit = 0;
  if (parameters_.time_step) {
    limit = *parameters_.time_step;
  } else {
    const StepLimits limits = done == 0 ? limits_ : size_.limits(level);
    limit = parameters_.safety_factor * (implicit ? implicit_limit(limits) : limits.explicit_viscous);
  }
  const double n = parts(remaining, limit);
  if (!(n + done <= most_sub_steps))
    throw SolveFailure(
        "The fluid would need more than {} sub-steps of {:.3g} s for the step of {:.3g} s at t = {:.6g} s. {}",
        most_sub_steps, limit, dt_, time_,
        parameters_.time_step ? " It follows from 'time-step'." : in_words(size_.limiter(level, implicit)));
  last = n == 1;
  return remaining / n;
}

template <int D>
double SubStepSize<D>::largest_peclet(const State<D>& state) {
  size_.limits(state);
  return size_.largest_peclet();
}

template class SubStepSize<2>;
template class SubStepSize<3>;

}  // namespace couplet::fluid
