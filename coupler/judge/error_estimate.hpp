// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/time/step_errors.hpp"
#include "coupler/acceleration/unknown.hpp"

namespace couplet::coupler {

/// What the iteration between participants leaves in the unknown below its tolerance: of a step whose residual fell
/// by the factor c in its last pass, |x - x*| <= c / (1 - c) |H(x) - x|; over all steps see StepErrors. Residuals
/// over the size of the unknown.
class CouplingErrorEstimate {
 public:
  void start_step() { residual_ = before_ = 0; }
  /// A pass through the group.
  void pass(const Residual& residual) { before_ = residual_, residual_ = residual.absolute; }
  /// The step is accepted; `change`: of the unknown over the step.
  void accepted(const Residual& last, const Residual& change, double dt);
  double over_size() const { return errors_.over_size(); }
  std::vector<double> state() const { return errors_.state(); }
  void restore(std::span<const double> state) { errors_.restore(state); }

 private:
  double residual_ = 0, before_ = 0;  // of the last two passes of the step under way; 0: none
  time::StepErrors errors_;
};

}  // namespace couplet::coupler
