// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "common/base/types.hpp"

namespace couplet::coupling {

/// Which step comes next. Nominal steps end at multiples of the nominal dt (the last one at the end time); a
/// step that fails is halved; after a while the halves grow back, later each time that was too early; nominal
/// times are always met. All sizes are the nominal one divided by a power of two, exactly: a solver that
/// keeps a factorised matrix for each dt meets few different ones.
class StepPlan {
 public:
  /// More nominal steps than this are refused: times would no longer be told apart.
  static constexpr double most_steps = 1e12;

  /// max_halvings: a step is halved at most this often (0 to 30). Throws Error for more than `most_steps`.
  StepPlan(double end_time, double nominal_dt, int max_halvings);

  bool finished() const { return nominal_ >= n_nominal_; }
  double time() const;   ///< t^n [s]
  double dt() const;     ///< of the step to try next; never beyond the next nominal time
  bool is_last() const;  ///< whether the step to try next ends the run
  /// Advice of the participants: the next steps are not longer than this if max_halvings allows.
  void limit(double largest_dt) { largest_dt_ = largest_dt; }
  void accepted();
  /// False if the step may not be halved any more.
  bool halve();
  /// True right after a nominal step was completed (outputs and checkpoints are made then).
  bool at_nominal_time() const { return tick_ == 0; }
  GlobalIndex steps_accepted() const { return accepted_; }
  int halvings() const { return level(); }

  /// For checkpoints.
  std::array<double, 6> state() const;
  /// `time`: the checkpoint's. The nominal dt may differ from that of the run that was saved if `time` is one
  /// of the new nominal times; throws Error otherwise.
  void restore(const std::array<double, 6>& state, double time);

 private:
  int level() const;  // halvings in force, made to fit the grid of ticks and the advice
  double nominal_time(GlobalIndex i) const;
  double nominal_length() const;  // of the nominal step under way [s]

  double end_time_, nominal_dt_;
  int max_halvings_;
  GlobalIndex n_nominal_;
  double largest_dt_;
  GlobalIndex nominal_ = 0;  // nominal steps completed
  long tick_ = 0;            // within the nominal step, in units of length / 2^max_halvings
  int wanted_level_ = 0;
  int calm_ = 0;      // steps accepted since the last failure or growth
  int patience_ = 2;  // so many calm steps before the next growth
  GlobalIndex accepted_ = 0;
};

}  // namespace couplet::coupling
