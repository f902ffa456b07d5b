// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace couplet::time {

/// Root mean square of the change of values over that of the values themselves, and over their range. Collective.
double change_over_size(MPI_Comm comm, std::span<const double> now, std::span<const double> before);
double change_over_range(MPI_Comm comm, std::span<const double> now, std::span<const double> before);

/// Distance from the steady state that a run approaches, from the relative changes c of its steps. If the last ones shrink by q per
/// step, the changes still to come sum to c q/(1 - q).
class Steadiness {
 public:
  /// Adds an accepted step of size dt [s]. A step of another size begins anew.
  void add(double change, double dt) {
    if (std::abs(dt - dt_) > 1e-6 * dt) changes_.clear();
    dt_ = dt;
    changes_.push_back(change);
    if (changes_.size() > steps) changes_.erase(changes_.begin());
  }
  /// Relative to the size of the solution; infinity while it is not known.
  double left() const {
    if (changes_.size() < steps) return std::numeric_limits<double>::infinity();
    const double last = changes_.back(), first = changes_.front();
    if (last == 0) return 0;
    const double q = std::pow(last / first, 1. / double(steps - 1));
    return q < 1 ? last * std::min(q / (1 - q), most_steps) : last * most_steps;
  }
  /// Archives the state in checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(dt_, changes_);
  }

 private:
  static constexpr std::size_t steps = 6;
  /// Number of further steps like the last one that are counted: what remains of a tolerance does not shrink.
  static constexpr double most_steps = 1e4;
  std::vector<double> changes_;
  double dt_ = 0;
};

}  // namespace couplet::time
