// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/large_strain/step_jump.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::solid {
namespace {

// Beyond both tangents, of the largest motion. Steps of a bonded rubber block, 16 x 16 cells: 0.08 at most next to a limit point of the cells at
// its rim, 0.13 to 0.95 past one; of a shallow arch from rest to 1.05 and 8 times its limit load 0.88 and 0.34.
constexpr double limit = 0.15;

}  // namespace

void StepJump::start(std::span<const double> u, int dim) {
  before_.assign(u.begin(), u.end());
  predicted_.assign(u.size(), 0);
  dim_ = std::size_t(dim);
}

void StepJump::predict(std::span<const double> u, std::span<const double> correction) {
  for (std::size_t i = 0; i < u.size(); ++i) predicted_[i] = u[i] - before_[i] + correction[i];
}

/// This rank's.
double StepJump::largest_growth(double length) const {
  double largest = 0;
  for (std::size_t i = 0; i < stretch_.size(); ++i)
    largest = std::max(largest, std::abs(stretch_[i] - (settled_.empty() ? 1 : settled_[i])));
  return largest * length;
}

/// By how much a node moves more than by the larger of both predictions and the growth, over the largest motion of a node; `later` may be empty.
double StepJump::beyond(MPI_Comm comm, std::span<const double> u, std::span<const double> later,
                        double growth) const {
  std::array<double, 3> found{0, 0, growth};
  for (std::size_t i = 0; i + dim_ <= u.size(); i += dim_) {
    double motion = 0, first = 0, last = 0;
    for (std::size_t k = i; k < i + dim_; ++k) {
      motion += (u[k] - before_[k]) * (u[k] - before_[k]);
      first += predicted_[k] * predicted_[k];
      if (!later.empty()) last += later[k] * later[k];
    }
    found[0] = std::max(found[0], std::sqrt(motion) - std::sqrt(std::max(first, last)));
    found[1] = std::max(found[1], std::sqrt(motion));
  }
  MPI_Allreduce(MPI_IN_PLACE, found.data(), 3, MPI_DOUBLE, MPI_MAX, comm);
  return found[1] > 0 ? (found[0] - found[2]) / found[1] : 0;
}

void StepJump::end(MPI_Comm comm, std::span<const double> u, double length, const Backward& backward) {
  const double growth = largest_growth(length);
  if (beyond(comm, u, {}, growth) <= limit) return;
  std::vector<double> later;
  try {
    later = backward(before_);
  } catch (const SolveFailure&) {
    return;  // an indefinite tangent: the least stiffness shows it
  }
  if (const double found = beyond(comm, u, later, growth); found > limit)
    throw SolveFailure(
        "The load step moved some of the body further than its stiffness before and after it gives, by {:.2g} of the "
        "largest motion (limit {:g}): it jumped past a limit point of the load, or past soft states that a shorter step "
        "finds; 'load-stepping: {{type: arc-length}}' follows a path through limit points.",
        found, limit);
}

}  // namespace couplet::solid
