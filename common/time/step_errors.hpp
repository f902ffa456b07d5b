// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/base/numbers.hpp"
#include "common/time/time_scheme.hpp"

namespace couplet::time {

/// Remaining effect of the local errors of all steps so far on the current solution.
///
/// An error propagates by the equation linearized about the solution, and so does the solution's own rate of
/// change if the equation does not depend on time; in a linear equation, its higher derivatives do, too. An error
/// C dt^{p+1} u^(p+1)(t_k) made at step k has therefore become C dt^{p+1} u^(p+1)(now): it has decayed like that
/// derivative, or like the rate of change if only that is known. Errors on the way to a steady state are forgotten, those of an
/// oscillation add up. Known damping may remove them faster while loads maintain the solution; the smaller
/// remainder counts. No error is assumed to grow or to exceed its cause: the error C dt^{p+1} u^(p+1) of
/// order p belongs to an oscillation of frequency w = |u^(p+1)| / |u^(p)| and amplitude |u^(p)| / w^p, so it
/// is at most twice that. All norms are taken over the whole field.
class StepErrors {
 public:
  struct Inputs {
    double error = 0;               ///< error of the step alone
    double rate = 0;                ///< |u'| at its end [1/s]
    double size = 0;                ///< |u|
    double dt = 0;                  ///< [s]
    int order = 0;                  ///< p; 0 if nothing more is known
    double below = 0, highest = 0;  ///< |u^(p)|, |u^(p+1)|
    double forgotten = 0;           ///< rate at which damping removes errors [1/s]; 0 if unknown
  };
  /// Adds a step, which represents `steps` steps if the first ones of a run cannot be judged.
  void add(const Inputs& seen, int steps = 1);
  /// Largest recent |u|.
  double size() const { return size_; }
  /// Remaining error relative to the size of the solution [1]. NaN before the first step.
  double over_size() const;
  /// Number of oscillations of the largest size that the solution has made: the integral of |u'| over four
  /// amplitudes.
  double swings() const { return largest_ > 0 ? way_ / (4 * largest_) : 0; }
  /// Archives the state in checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(rate_, size_, below_, highest_, time_, amplitude_, errors_, way_, largest_);
    for (const auto& [of, sum] : errors_)
      if (!amplitude_.contains(of.first)) numbers.damaged();
  }
  std::vector<double> state() const { return base::to_numbers(*this); }
  /// Restores the state. It is empty for a run that did not collect errors.
  void restore(std::span<const double> state) {
    *this = {};
    if (!state.empty()) base::from_numbers(state, *this, "step errors");
  }

 private:
  struct Sum {
    double all = 0, kept = 0;  // sum of original errors, and what damping has left of them
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(all, kept);
    }
  };
  /// Largest recent |u^(p+1)|, or |u'| if that is not known.
  double fading() const { return highest_ > 0 ? highest_ : rate_; }
  // Sums by the binary logarithms of the frequency and of that derivative when they were made.
  std::map<std::pair<int, int>, Sum> errors_;
  std::map<int, double> amplitude_;  // largest, by the binary logarithm of the frequency
  // Largest recent values, since an oscillation passes through zero rate and zero size.
  double rate_ = 0, size_ = 0, below_ = 0, highest_ = 0, time_ = 0;
  double way_ = 0, largest_ = 0;  // integral of |u'|, largest |u|
};

/// StepErrors of a second-order equation. Local errors C dt^{p+1} d^{p+1}u/dt^{p+1} are estimated from the
/// velocities at the ends of the last two or three steps.
class VelocityErrors {
 public:
  /// Norm of a field like the velocity, the same on all ranks.
  using Norm = std::function<double(std::span<const double>)>;

  /// `begins_with_euler`: the first step of a second-order scheme is one of Euler.
  explicit VelocityErrors(const TimeSchemeParameters& scheme, bool begins_with_euler = false)
      : local_(local_error(scheme)), begins_with_euler_(begins_with_euler) {}
  /// Adds a step dt after dt_old that changed the velocity from `before` to `now` [m/s]. `size` is |u| at its
  /// end; `forgotten` is the rate at which damping removes errors [1/s]. A second-order scheme cannot be
  /// judged in its first step, so the next one represents it. Returns the estimate. Collective if `norm` is.
  StepErrors::Inputs add(std::span<const double> before, std::span<const double> now, double dt,
                         double dt_old, double size, const Norm& norm, double forgotten = 0);
  double over_size() const { return errors_.over_size(); }
  double size() const { return errors_.size(); }
  double swings() const { return errors_.swings(); }
  /// State for checkpoints. Empty for a run that collected nothing.
  std::vector<double> state() const;
  void restore(std::span<const double> state);
  /// Values that are the same on all ranks, and this rank's velocity. Empty before the first step.
  std::vector<double> numbers() const;
  std::span<const double> before() const { return v_before_; }
  void restore(std::span<const double> numbers, std::vector<double> before);

  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(v_before_);
    visit_sums(numbers);
  }

 private:
  VelocityErrors(const LocalError& local, bool begins_with_euler)
      : local_(local), begins_with_euler_(begins_with_euler) {}
  template <class Numbers>
  void visit_sums(Numbers& numbers) {
    int kind = (judged_ ? 1 : 0) + (has_before_ ? 2 : 0);
    numbers(kind, errors_);
    judged_ = kind % 2 == 1;
    has_before_ = kind >= 2;
  }

  LocalError local_;
  bool begins_with_euler_;
  std::vector<double> v_before_;  // at the start of the previous step
  bool has_before_ = false;       // also true on a rank without cells
  bool judged_ = false;           // a step has been judged
  StepErrors errors_;
};

}  // namespace couplet::time
