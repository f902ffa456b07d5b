// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/linalg/linear_map.hpp"
#include "common/linalg/linear_solver.hpp"

namespace couplet::linalg {

class PetscGmres;
class ResidualProjection;

struct KrylovOptions {
  double relative_tolerance = 1e-8;  ///< of |b - A x| / |b|
  int max_iterations = 500;
  bool is_symmetric = false;  ///< A and the preconditioner are, and positive: conjugate gradients
  bool is_hard = false;       ///< known to be slow for BiCGStab: GMRES from the start
  int carried =
      0;  ///< after so many iterations of conjugate gradients at most, the residual they carry counts as true
};

/// BiCGStab [vandervorst1992] preconditioned from the right, for operators that are only applied; where it
/// has not converged after 50 iterations, PETSc's GMRES goes on, which needs more memory and tolerates more. The
/// residual that is judged is the true one, b - A x: the recurrence drifts away from it on long runs, so that
/// it is computed anew when the recurrence has reached the tolerance (but for KrylovOptions::carried), and the iteration begins again from
/// there if it has not. Symmetric positive pairs take preconditioned conjugate gradients [hestenes1952] in
/// their place, under the same rules. A residual that is only what rounding leaves in A x counts as reached.
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
  void try_bicgstab(std::span<double> x, double wanted, int max_iterations, SolveStatistics& statistics);
  void run_bicgstab(std::span<double> x, double wanted, int max_iterations, SolveStatistics& statistics);
  void run_cg(std::span<double> x, double wanted, int max_iterations, SolveStatistics& statistics);
  void run_gmres(std::span<double> x, double wanted, int max_iterations, SolveStatistics& statistics);

  std::string what_;
  MPI_Comm comm_;
  std::size_t n_;
  LinearMap apply_, precondition_;
  std::vector<double> r_, shadow_, p_, v_, t_, z_;
  std::unique_ptr<PetscGmres> gmres_;  // while it is needed
  bool is_announced_ = false;
};

}  // namespace couplet::linalg
