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

/// What the local errors of all steps so far leave in the solution now.
///
/// An error propagates by the equation linearised about the solution, and so does the solution's own rate of change
/// where the equation does not depend on time: what was made at step k has since shrunk as the rate of change has,
/// |u'(now)| / |u'(t_k)|. So errors on the way to a steady state are forgotten, those of an oscillation add up, unless damping is known to take
/// them away while loads keep the solution going: of the two the one that leaves less counts. None
/// is taken to grow, and none to exceed what it is an error of: a scheme of order p errs by C dt^{p+1} u^(p+1), which
/// belongs to a swing of frequency w = |u^(p+1)| / |u^(p)| and amplitude |u^(p)| / w^p, out of phase by at most twice
/// that. All are norms of one kind over the whole field, the same on all ranks.
class StepErrors {
 public:
  struct Seen {
    double error = 0;               ///< what the step alone left
    double rate = 0;                ///< |u'| at its end [1/s]
    double size = 0;                ///< |u|
    double dt = 0;                  ///< [s]
    int order = 0;                  ///< p; 0: nothing more is known
    double below = 0, highest = 0;  ///< |u^(p)|, |u^(p+1)|
    double forgotten = 0;           ///< rate at which damping takes errors away [1/s]; 0: not known
  };
  /// `steps`: that it stands for, of which the first ones of a run cannot be judged by themselves.
  void add(const Seen& seen, int steps = 1);
  /// |u|, the largest of late.
  double size() const { return size_; }
  /// The error left over the size of the solution [1]; NaN before the first step.
  double over_size() const;
  /// For checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(rate_, size_, below_, highest_, time_, amplitude_, errors_);
    for (const auto& [of, sum] : errors_)
      if (!amplitude_.contains(of.first)) numbers.damaged();
  }
  std::vector<double> state() const { return base::to_numbers(*this); }
  /// Empty: of a run that did not collect them.
  void restore(std::span<const double> state) {
    *this = {};
    if (!state.empty()) base::from_numbers(state, *this, "step errors");
  }

 private:
  struct Sum {
    double all = 0, kept = 0;  // as they were made; of these what damping has not taken away
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(all, kept);
    }
  };
  // By the binary logarithms of frequency and of the rate when they were made.
  std::map<std::pair<int, int>, Sum> errors_;
  std::map<int, double> amplitude_;  // largest, by the binary logarithm of the frequency
  // Largest of late: an oscillation passes through places of no rate or no size.
  double rate_ = 0, size_ = 0, below_ = 0, highest_ = 0, time_ = 0;
};

/// StepErrors of a second-order equation, whose local errors C dt^{p+1} d^{p+1}u/dt^{p+1} are told from the velocities at
/// the ends of the last two or three steps.
class VelocityErrors {
 public:
  /// Norm of a field like the velocity, the same on all ranks.
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
  /// Gives the state in two parts: numbers that are the same on all ranks, and the velocity, of this rank; empty: not yet.
  std::vector<double> numbers() const;
  std::span<const double> before() const { return v_before_; }
  void restore(std::span<const double> numbers, std::vector<double> before);

  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(v_before_);
    visit_sums(numbers);
  }

 private:
  explicit VelocityErrors(const LocalError& local) : local_(local) {}
  template <class Numbers>
  void visit_sums(Numbers& numbers) {
    int kind = (judged_ ? 1 : 0) + (has_before_ ? 2 : 0);
    numbers(kind, errors_);
    judged_ = kind % 2 == 1;
    has_before_ = kind >= 2;
  }

  LocalError local_;
  std::vector<double> v_before_;  // at the start of the step before
  bool has_before_ = false;       // a rank without cells has it, too
  bool judged_ = false;           // a step has been judged
  StepErrors errors_;
};

}  // namespace couplet::time
