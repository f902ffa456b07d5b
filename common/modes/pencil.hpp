// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"

namespace couplet::modes {

/// Eigenvalue problem K x = lambda M x, defined by operators on the owned rows of a vector. All are symmetric
/// and collective; M is positive semidefinite. The functions below rethrow their exceptions.
struct Pencil {
  MPI_Comm comm;
  std::size_t n;  ///< number of rows of this rank
  linalg::LinearMap k, m;
  linalg::LinearMap solve;  ///< inverse that the search applies
};

/// Eigenpairs on the owned rows.
struct EigenModes {
  std::vector<double> eigenvalue;
  std::vector<std::vector<double>> shape;  ///< x . M x = 1
  double next = 0;                         ///< an eigenvalue beyond those found
  double worst_residual = 0;               ///< |K x - lambda M x| over |lambda - shift| |M x|
};

/// Finds the lowest `n` modes in ascending order by shift-invert Krylov-Schur about `shift` < 0
/// [hernandez2005]. K is positive semidefinite; solve = (K - shift M)^-1. Repeated eigenvalues may hide
/// members, so the result is checked. `count_below(s)` gives the number of eigenvalues below s (negative
/// pivots of K - s M, by Sylvester's law of inertia). Without it, a further search must only find larger
/// ones. Throws SolveFailure if there are too few, the search fails or modes stay hidden. Collective.
EigenModes lowest_modes(const Pencil& pencil, int n, double shift,
                        const std::function<GlobalIndex(double)>& count_below = {});
/// Overload that factorizes the matrices. Rows of M may be zero. Throws Error for fewer unknowns than modes.
EigenModes lowest_modes(const linalg::SparseMatrix& stiffness, const linalg::SparseMatrix& mass, int n,
                        double shift);

/// Finds the `n` largest modes in descending order by Krylov-Schur on M^-1 K with positive M; solve = M^-1.
/// Returns fewer, or none, if they do not converge, e.g. for negative K. Collective.
EigenModes largest_modes(const Pencil& pencil, int n);

struct LowestQuotient {
  double value = 0;  ///< Rayleigh quotient of x, an upper bound of the minimum
  int iterations = 0;
  std::vector<double> x;
};

/// Minimizes x . K x / x . M x from `start` by conjugate gradients that are optimal in the space of the
/// iterate, its preconditioned residual and the last step [knyazev2001]. M is positive; solve approximates
/// K^-1 or M^-1. `enough(values)` is called after each iteration with all values so far. Every value is an
/// upper bound, so a negative one proves indefiniteness. Collective.
LowestQuotient lowest_quotient(const Pencil& pencil, const std::vector<double>& start, int most_iterations,
                               const std::function<bool(const std::vector<double>&)>& enough);

struct Curvature {
  bool is_negative = false;  ///< x . A x < 0, which proves that A is not positive
  std::vector<double> x;     ///< that direction, else the approximate solution of A x = b
  int iterations = 0;
};

/// Applies conjugate gradients to A x = b with symmetric A until |r| <= `tolerance` |b| or it finds a
/// direction of negative curvature. Almost any b reveals an A that is not positive. Collective.
Curvature find_negative_curvature(MPI_Comm comm, const linalg::LinearMap& a,
                                  const linalg::LinearMap& precondition, std::span<const double> b,
                                  double tolerance, int most_iterations);

/// Returns true if the last mode and the next one differ by less than `tolerance` of the larger one. A group
/// that is cut in two responds differently in different directions.
bool cuts_a_group(const EigenModes& modes, double tolerance);

}  // namespace couplet::modes
