// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/linalg/linear_map.hpp"

namespace couplet::linalg {

/// IDR(4) [vangijzen2011], preconditioned from the right: residuals in spaces that shrink, four directions at
/// a time. A few eigenvalues far from the others, on which BiCGStab spends hundreds of iterations, cost it a
/// few dozen; it needs 14 vectors.
class Idr {
 public:
  /// `n`: rows of this rank.
  Idr(MPI_Comm comm, std::size_t n);
  /// Moves `x` and its residual `r` until |r| <= wanted by the recurrence, or until that breaks down. Counts
  /// in `applications` what was preconditioned and applied, at most `most` of them. Collective.
  void run(const LinearMap& apply, const LinearMap& precondition, std::span<double> r, std::span<double> x,
           double wanted, int most, int& applications);

 private:
  static constexpr int s = 4;
  using Vectors = std::vector<double>[s];

  MPI_Comm comm_;
  std::vector<float> shadow_[s];
  Vectors images_, directions_;  // images: A directions
  std::vector<double> v_, z_;
};

}  // namespace couplet::linalg
