// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"

namespace couplet::modes {

/// SLEPc beside a PETSc that is up already. Made on all ranks of the program (collective); at most one at a
/// time.
class SlepcEnvironment final {
 public:
  SlepcEnvironment();
  ~SlepcEnvironment();
  SlepcEnvironment(const SlepcEnvironment&) = delete;
  SlepcEnvironment& operator=(const SlepcEnvironment&) = delete;
};

/// Lowest solutions of K x = lambda M x.
struct EigenModes {
  std::vector<double> eigenvalue;          ///< [1/s^2], ascending
  std::vector<std::vector<double>> shape;  ///< x on the owned rows, x . M x = 1
  double next = 0;                         ///< an eigenvalue beyond them [1/s^2]
  double worst_residual =
      0;  ///< |K x - lambda M x| over |lambda - shift| |M x|, or PETSc's backward error with matrices
};

/// The lowest `n` modes by shift-invert Krylov-Schur about `shift` < 0 [hernandez2005], K symmetric and not
/// negative, M symmetric and not negative (rows of M may be zero: K alone holds them). That none was missed
/// is checked by the number of negative pivots of K - s M above the last mode (Sylvester's law of inertia),
/// which repeated eigenvalues make necessary. Throws Error if there are fewer modes than asked for,
/// SolveFailure if the iteration fails or modes stay hidden. Needs a SlepcEnvironment. Collective over the
/// matrices' ranks.
EigenModes lowest_modes(const linalg::SparseMatrix& stiffness, const linalg::SparseMatrix& mass, int n,
                        double shift);

/// K and M by what they do to the owned rows of a vector, each collective. K symmetric and not negative, M too.
struct ModalOperators {
  using Apply = std::function<void(std::span<const double> x, std::span<double> y)>;
  Apply stiffness, mass;
  Apply solve;  ///< y = (K - shift M)^{-1} x; what it throws comes out of lowest_modes
};

/// The same of operators without entries, by shift-invert with the caller's own solver. That none was missed is
/// checked by a search beside those found, whose first eigenvalue must lie above them. Throws SolveFailure if there
/// are fewer. Needs a SlepcEnvironment. Collective over `comm`.
EigenModes lowest_modes(MPI_Comm comm, std::size_t n_owned, const ModalOperators& of, int n, double shift);

/// Modes whose eigenvalues differ by less than `tolerance` of the larger one, as the last one that is kept
/// and the first one that is not: a group cut in two answers differently in different directions.
bool cuts_a_group(const EigenModes& modes, double tolerance);

}  // namespace couplet::modes
