// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <vector>

#include "common/linalg/linear_map.hpp"

namespace couplet::modes {

/// A and B by what they do to the owned rows of a vector, each collective. Both symmetric, B positive.
struct RatioOperators {
  linalg::LinearMap a, b;
  linalg::LinearMap solve_b;  ///< y = B^{-1} x; what it throws comes out of largest_ratios
};

/// Largest solutions of A x = mu B x.
struct Ratios {
  std::vector<double> value;               ///< mu, descending
  std::vector<std::vector<double>> shape;  ///< x on the owned rows, x . B x = 1
};

/// The `n` largest by Krylov-Schur on B^{-1} A [hernandez2005]; fewer, or none, where those do not converge, as where A is not
/// positive for any x and its largest ratios crowd below zero. Needs a SlepcEnvironment. Collective over `comm`.
Ratios largest_ratios(MPI_Comm comm, std::size_t n_owned, const RatioOperators& of, int n);

}  // namespace couplet::modes
