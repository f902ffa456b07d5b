// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/fluid.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Largest unseen share of the load. The motion of a body that starts is wrong by ten times as much.
constexpr double largest_unseen_share = 0.001;
// In the third pass w is better than the guess. After a renewal this holds in the second pass if the gap has
// decreased by this factor, as with quasi-Newton methods but not with relaxation.
constexpr int enough_passes = 3;
// Part of the load that is not uniform below which it is rounding, and the share of it says nothing.
constexpr double uniform = 1e-5;
constexpr double shrunk = 0.7;
constexpr int most = 4;  // then the whole step might as well be iterated
constexpr double least_factor = 0.1, largest_factor = 1;

template <int D>
double squares(const Vectors<D>& v) {
  double sum = 0;
  for (const Vec<D>& value : v) sum += value.squaredNorm();
  return sum;
}

}  // namespace

template <int D>
void Renewal<D>::start(const Vectors<D>& w) {
  guess_ = w;
  gap_.clear();
  factor_ = 1;
  passes_ = 1;
  count_ = 0;
}

template <int D>
bool Renewal<D>::is_good(MPI_Comm comm, const Vectors<D>& w) const {
  if (passes_ >= enough_passes) return true;
  if (count_ == 0) return false;
  double sums[2] = {0, squares<D>(gap_)};
  for (std::size_t b = 0; b < w.size(); ++b) sums[0] += (w[b] - guess_[b]).squaredNorm();
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm);
  return sums[0] < shrunk * shrunk * sums[1];
}

/// g + omega (w - g), omega as in (13).
template <int D>
void Renewal<D>::move_guess(MPI_Comm comm, const Vectors<D>& w) {
  const bool first = gap_.empty();
  gap_.resize(w.size(), Vec<D>::Zero());
  double sums[2] = {};
  for (std::size_t b = 0; b < w.size(); ++b) {
    const Vec<D> gap = w[b] - guess_[b], change = gap - gap_[b];
    sums[0] += gap_[b].dot(change);
    sums[1] += change.squaredNorm();
    gap_[b] = gap;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm);
  if (!first && sums[1] > 0) factor_ = std::clamp(-factor_ * sums[0] / sums[1], least_factor, largest_factor);
  for (std::size_t b = 0; b < w.size(); ++b) guess_[b] += factor_ * gap_[b];
}

template <int D>
bool Renewal<D>::wanted(MPI_Comm comm, const Vectors<D>& w, double unseen, double of_all) {
  ++passes_;
  if (unseen <= largest_unseen_share || !is_good(comm, w)) return false;
  if (count_ == most && of_all <= uniform * unseen) return false;
  if (count_ == most)
    throw SolveFailure(
        "After {} predictions of the velocity, the viscous force on the moving wall has still not converged: it is off by "
        "{:.2g} % of the load (limit {:g} %). Semi-implicit steps do not suffice here; try `coupling.scheme: implicit`.",
        most, 100 * unseen, 100 * largest_unseen_share);
  move_guess(comm, w);
  passes_ = 1;
  ++count_;
  return true;
}

template class Renewal<2>;
template class Renewal<3>;

}  // namespace couplet::fluid
