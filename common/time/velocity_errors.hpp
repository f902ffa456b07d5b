// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "common/time/step_errors.hpp"
#include "common/time/time_scheme.hpp"

namespace couplet::time {

/// StepErrors of a second-order equation, whose local errors C dt^{p+1} d^{p+1}u/dt^{p+1} are told from the velocities at
/// the ends of the last two or three steps.
class VelocityErrors {
 public:
  /// Of a field like the velocity, the same on all ranks.
  using Norm = std::function<double(std::span<const double>)>;

  explicit VelocityErrors(const TimeSchemeParameters& scheme) : local_(local_error(scheme)) {}
  /// A step of dt after one of dt_old took the velocity from `before` to `now` [m/s]; `size`: |u| at its end;
  /// `forgotten`: rate at which damping takes errors away [1/s]. A scheme of
  /// second order cannot be judged in its first step; the next one stands for it. Gives what was seen. Collective if
  /// `norm` is.
  StepErrors::Seen add(std::span<const double> before, std::span<const double> now, double dt, double dt_old,
                       double size, const Norm& norm, double forgotten = 0);
  double over_size() const { return errors_.over_size(); }
  /// For checkpoints; empty: of a run that collected nothing.
  std::vector<double> state() const;
  void restore(std::span<const double> state);
  /// The same in two parts: numbers that are the same on all ranks, and the velocity, of this rank; empty: not yet.
  std::vector<double> numbers() const;
  std::span<const double> before() const { return v_before_; }
  void restore(std::span<const double> numbers, std::vector<double> before);

 private:
  LocalError local_;
  std::vector<double> v_before_;  // at the start of the step before
  bool has_before_ = false;       // a rank without cells has it, too
  bool judged_ = false;           // a step has been judged
  StepErrors errors_;
};

}  // namespace couplet::time
