// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <vector>

#include "common/linalg/linear_map.hpp"

namespace couplet::modes {

/// A and B symmetric, B positive; `precondition` near B^{-1} or A^{-1}.
struct QuotientOperators {
  linalg::LinearMap a, b, precondition;
};

struct LowestQuotient {
  double value = 0;  ///< of x: never below the least
  int iterations = 0;
  std::vector<double> x;
};

/// The least x . A x / x . B x from the start x on, by conjugate gradients that are optimal in the space of the iterate, its
/// preconditioned residual and the last step [knyazev2001]. `enough(values)`: asked after each iteration with all values so
/// far. Few iterations give a bound from above, which a negative value makes a proof. Collective.
LowestQuotient lowest_quotient(MPI_Comm comm, const QuotientOperators& of, std::vector<double> start,
                               int most_iterations,
                               const std::function<bool(const std::vector<double>&)>& enough);

}  // namespace couplet::modes
