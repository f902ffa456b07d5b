// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/coupling/step_errors.hpp"
#include "common/time/time_scheme.hpp"
#include "plate_modal/oscillators.hpp"

namespace couplet::plate {

/// What time steps leave in the modes' displacements: sum of the local errors C dt^{p+1} d^{p+1}q/dt^{p+1}, see
/// StepErrors. Modes of unit mass: their norm is the root of the integral of the density times the square of the
/// displacement. Every rank has all modes.
class StepErrorEstimate {
 public:
  explicit StepErrorEstimate(const TimeSchemeParameters& scheme) : scheme_(scheme) {}
  /// A step was accepted.
  void accepted(const ModalState& before, const ModalState& after);
  double over_size() const { return errors_.over_size(); }
  /// For checkpoints; empty: of a run that collected nothing.
  std::vector<double> state() const;
  void restore(std::span<const double> state);

 private:
  TimeSchemeParameters scheme_;
  std::vector<double> v_before_;  // at the start of the step before; empty: not yet
  bool seen_ = false;             // a step has been judged
  StepErrors errors_;
};

}  // namespace couplet::plate
