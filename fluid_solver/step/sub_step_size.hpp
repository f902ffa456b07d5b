// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/step/step_size.hpp"

namespace couplet::fluid {

/// How a coupling step is cut into sub-steps, and which treatment of the viscous term they have.
template <int D>
class SubStepSize {
 public:
  SubStepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary, const FluidParameters& parameters);

  /// Sets whether operators are of fourth order.
  void set_fourth(bool fourth) { size_.set_fourth(fourth); }
  /// Begins a coupling step [s] that starts from `level`; `frame_rate`: see StepSize. Chooses begin.implicit, and begins the
  /// multi-step schemes anew where that changes. Collective.
  void begin_step(const State<D>& level, double time, double dt, double frame_rate, History<D>& begin);
  /// Equal parts of what remains [s], each within the limit of the present flow; `done`: sub-steps so far. Throws
  /// SolveFailure if there would be too many. Collective.
  double next(const State<D>& level, bool implicit, int done, double remaining, bool& last);
  /// At the begin of the last step; left out where nothing depends on them.
  const StepLimits& limits() const { return limits_; }
  /// Largest cell Reynolds number |phi| / (nu g) of a state. Collective.
  double largest_peclet(const State<D>& state);
  /// The cell that limits the steps that follow a state. Collective.
  StepLimiter limiter(const State<D>& state) { return size_.limiter(state, state.implicit); }

 private:
  void choose_viscous_treatment(const State<D>& level, History<D>& begin);
  double implicit_limit(const StepLimits& limits) const;

  const FluidParameters& parameters_;
  StepSize<D> size_;
  double time_ = 0, dt_ = 0;
  StepLimits limits_;
};

}  // namespace couplet::fluid
