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
  /// Up to this number of iterations, conjugate gradients' own residual counts as the true one.
  int carried = 0;
  double absolute_tolerance = 0;  ///< of |b - A x|
  int patience = 50;              ///< iterations of BiCGStab after which GMRES takes over
};

/// Conjugate gradients, BiCGStab and PETSc's GMRES for operators that are only applied, with rules about residuals. BiCGStab is preconditioned from
/// the right; where it has not converged after KrylovOptions::patience, GMRES goes on, which needs more memory and tolerates
/// more. Symmetric positive pairs take conjugate gradients. The residual that is judged is the true one, b - A x: the
/// recurrence drifts away from it on long runs, so it is computed anew when the recurrence has reached the tolerance (except
/// for KrylovOptions::carried), and the iteration begins again from there if it has not. A residual that is only what
/// rounding leaves in A x counts as reached.
class KrylovSolver {
 public:
  /// `what` names the unknown in messages. `n`: rows of this rank.
  KrylovSolver(std::string what, MPI_Comm comm, std::size_t n, LinearMap apply, LinearMap precondition);
  ~KrylovSolver();

  /// `x` holds the guess on entry, which `projection`, if there is one, moves on. Throws SolveFailure if the
  /// tolerance was not reached. Collective.
  SolveStatistics solve(std::span<const double> b, std::span<double> x, const KrylovOptions& options,
                        ResidualProjection* projection = nullptr);
  /// Gives the memory of its vectors back until the next solve.
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
