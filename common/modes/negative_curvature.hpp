// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/linalg/linear_map.hpp"

namespace couplet::modes {

struct Curvature {
  bool is_negative = false;  ///< x . A x <= 0: A is not positive, which is proved by x
  std::vector<double> x;     ///< that direction, else the solution of A x = b as far as it was found
  int iterations = 0;
};

/// Conjugate gradients [hestenes1952] on A x = b, A symmetric, until |r| <= `tolerance` |b| or a direction of negative curvature is met. An A
/// that is not positive is met so for nearly any b: the iteration resolves what it solves for. Collective.
Curvature look_for_negative_curvature(MPI_Comm comm, const linalg::LinearMap& a,
                                      const linalg::LinearMap& precondition, std::span<const double> b,
                                      double tolerance, int most_iterations);

}  // namespace couplet::modes
