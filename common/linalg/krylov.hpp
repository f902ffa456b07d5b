// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "common/linalg/petsc.hpp"

namespace couplet::linalg {

class ResidualProjection;

struct KrylovOptions {
  double relative_tolerance = 1e-8;  ///< of |b - A x| / |b|
  int max_iterations = 500;
  bool is_symmetric = false;  ///< A and the preconditioner are symmetric and positive: conjugate gradients
  bool is_hard = false;       ///< known to be slow for BiCGStab: GMRES from the start
  /// Number of iterations up to which the recursive residual of conjugate gradients is trusted.
  int carried = 0;
  double absolute_tolerance = 0;  ///< of |b - A x|
  int patience = 50;              ///< iterations of BiCGStab after which GMRES takes over
};

/// Conjugate gradients, BiCGStab and PETSc's GMRES for matrix-free operators. Symmetric positive pairs use
/// conjugate gradients. Others use BiCGStab with right preconditioning, then GMRES after
/// KrylovOptions::patience iterations, which is more robust but needs more memory. Convergence is judged by
/// the true residual b - A x, from which the recurrence drifts. When the recurrence reaches the tolerance,
/// the residual is recomputed (except for KrylovOptions::carried), and the iteration restarts if necessary. A
/// residual at the round-off of A x counts as converged.
class KrylovSolver {
 public:
  /// `what` names the unknown in messages. `n` is the number of rows of this rank.
  KrylovSolver(std::string what, MPI_Comm comm, std::size_t n, LinearMap apply, LinearMap precondition);
  ~KrylovSolver();

  /// Solves from the guess in `x`, which `projection` improves if given. Throws SolveFailure if the tolerance
  /// is not reached. Collective.
  SolveStatistics solve(std::span<const double> b, std::span<double> x, const KrylovOptions& options,
                        ResidualProjection* projection = nullptr);
  /// Frees its vectors until the next solve.
  void forget_vectors();

 private:
  double true_residual(std::span<const double> b, std::span<const double> x);
  double rounding(std::span<const double> x);
  int run_gmres(std::span<double> x, double wanted, int most, bool continues);

  std::string what_;
  MPI_Comm comm_;
  std::size_t n_;
  LinearMap apply_, precondition_;
  std::vector<double> r_;
  std::unique_ptr<PetscGmres> gmres_;  // created on first use
  bool is_announced_ = false;
};

}  // namespace couplet::linalg
