// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"

namespace couplet::modes {

/// K x = lambda M x, by what the operators do to the owned rows of a vector. All are symmetric and collective; M is not
/// negative. What they throw comes out of the functions below.
struct Pencil {
  MPI_Comm comm;
  std::size_t n;  ///< rows of this rank
  linalg::LinearMap k, m;
  linalg::LinearMap solve;  ///< inverse that the search applies
};

/// Solutions on the owned rows.
struct EigenModes {
  std::vector<double> eigenvalue;
  std::vector<std::vector<double>> shape;  ///< x . M x = 1
  double next = 0;                         ///< an eigenvalue beyond them
  double worst_residual = 0;               ///< |K x - lambda M x| over |lambda - shift| |M x|
};

/// The lowest `n`, ascending, by shift-invert Krylov-Schur about `shift` < 0 [hernandez2005]. K is not negative;
/// solve = (K - shift M)^-1. Repeated eigenvalues may hide members from one search, so the result is checked:
/// `count_below(s)` gives the number of eigenvalues below s above the last one (negative pivots of K - s M, by Sylvester's
/// law of inertia). Without it, the first eigenvalue of a search beside those found must lie above them. Throws SolveFailure
/// if there are fewer, the search fails or modes stay hidden. Collective.
EigenModes lowest_modes(const Pencil& pencil, int n, double shift,
                        const std::function<GlobalIndex(double)>& count_below = {});
/// The same with factors of the matrices. Rows of M may be zero. Throws Error if there are fewer unknowns than modes.
EigenModes lowest_modes(const linalg::SparseMatrix& stiffness, const linalg::SparseMatrix& mass, int n,
                        double shift);

/// The `n` largest, descending, by Krylov-Schur on M^-1 K, M positive; solve = M^-1. Fewer, or none, where they do not
/// converge: for example, where K is not positive for any x and its largest ratios crowd below zero. Collective.
EigenModes largest_modes(const Pencil& pencil, int n);

struct LowestQuotient {
  double value = 0;  ///< of x: never below the least
  int iterations = 0;
  std::vector<double> x;
};

/// The least x . K x / x . M x, from `start` on, by conjugate gradients that are optimal in the space of the iterate, its
/// preconditioned residual and the last step [knyazev2001]. M is positive; solve is near K^-1 or M^-1.
/// `enough(values)` is asked after each iteration with all values so far. A few iterations give a bound from above, which a
/// negative value makes a proof. Collective.
LowestQuotient lowest_quotient(const Pencil& pencil, const std::vector<double>& start, int most_iterations,
                               const std::function<bool(const std::vector<double>&)>& enough);

struct Curvature {
  bool is_negative = false;  ///< x . A x < 0, which proves that A is not positive
  std::vector<double> x;     ///< that direction, else the solution of A x = b as far as it was found
  int iterations = 0;
};

/// Conjugate gradients on A x = b, A symmetric, until |r| <= `tolerance` |b| or a direction of negative curvature is met. An
/// A that is not positive is met for nearly any b, because the iteration resolves what it solves for. Collective.
Curvature look_for_negative_curvature(MPI_Comm comm, const linalg::LinearMap& a,
                                      const linalg::LinearMap& precondition, std::span<const double> b,
                                      double tolerance, int most_iterations);

/// Whether the last mode that is kept and the first one that is not differ by less than `tolerance` of the larger one: a
/// group cut in two answers differently in different directions.
bool cuts_a_group(const EigenModes& modes, double tolerance);

}  // namespace couplet::modes
