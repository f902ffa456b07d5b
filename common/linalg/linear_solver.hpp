// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscksp.h>

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/linalg/matrix.hpp"
#include "common/linalg/petsc.hpp"

namespace couplet::linalg {

enum class LinearMethod {
  direct,            ///< LU: PETSc's own for small matrices (replicated on every rank), else MUMPS
  direct_symmetric,  ///< Cholesky, likewise
  direct_planar,     ///< Cholesky of a positive definite 2-D matrix, on one rank by CHOLMOD
  cg_direct,         ///< CG with reused Cholesky factors, on one rank PETSc's own: 2-D, positive definite
  cg_multigrid,      ///< CG with smoothed aggregation, symmetric SOR
  gmres_multigrid,   ///< GMRES with BoomerAMG
  bicgstab_ilu,      ///< KrylovSolver's BiCGStab and GMRES with ILU(0), block Jacobi over the ranks
  cg_icc,            ///< CG with incomplete Cholesky factors, block Jacobi over the ranks
};

class KrylovSolver;

struct LinearOptions {
  LinearMethod method = LinearMethod::cg_multigrid;
  double relative_tolerance = 1e-8;   ///< of |r| / |b|
  double absolute_tolerance = 1e-50;  ///< of |r|; may also be given with each solve
  int max_iterations = 500;
  /// Skips the residual of a direct method, which would cost one more product.
  bool as_preconditioner = false;
};

struct SolveStatistics {
  int iterations = 0;
  int inner_iterations = 0;  ///< of solves within an iteration, or 0
  double residual = 0;
  double seconds = 0;
};

/// Memory of a solver about its preconditioner, except for the matrix. With that matrix the preconditioner
/// can be rebuilt bit for bit after a restart.
struct PreconditionerMemory {
  bool is_due = true;  ///< rebuild at the next solve
  int most_iterations = 0;
  bool operator==(const PreconditionerMemory&) const = default;
};

/// Krylov or direct solver that reuses its preconditioner until refreshed.
class LinearSolver {
 public:
  /// `what` names the unknown in error messages, e.g. "pressure".
  LinearSolver(std::string what, const SparseMatrix& matrix, const LinearOptions& options);
  ~LinearSolver();
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// Solves A x = b on the owned rows from the initial guess in x. Throws SolveFailure with the name and
  /// PETSc's reason if it does not converge or the result is not finite. Collective.
  SolveStatistics solve(std::span<const double> b, std::span<double> x);
  SolveStatistics solve(std::span<const double> b, std::span<double> x, double relative_tolerance,
                        double absolute_tolerance);
  /// Announces changed matrix values. Direct methods factorize again at the next solve. Krylov methods keep
  /// their preconditioner while iterations stay below twice those right after it was built (plus 2), and
  /// rebuild it when it fails.
  void matrix_changed();
  /// Uses the result of `make` as preconditioner whenever a new one is due.
  void set_preconditioner(std::function<LinearMap()> make);
  /// Rebuilds the preconditioner at the next solve.
  void refresh();
  PreconditionerMemory memory() const { return {rebuild_, most_iterations_}; }
  /// Builds the preconditioner that belongs to `memory` from the current matrix. Collective.
  void restore(const PreconditionerMemory& memory);
  int preconditioners_built() const { return built_; }
  /// Norm of `values` over all ranks. Collective.
  double norm(std::span<const double> values) const;
  /// Computes |b - A x|. Collective.
  double true_residual(std::span<const double> b, std::span<const double> x) const;

 private:
  void make_preconditioner();
  KSPConvergedReason attempt(std::span<const double> b, std::span<double> x, double relative_tolerance,
                             double absolute_tolerance, SolveStatistics& statistics);

  std::string what_;
  LinearOptions options_;
  const SparseMatrix* matrix_;
  std::unique_ptr<KrylovSolver> krylov_;  // for bicgstab_ilu
  std::function<LinearMap()> make_;       // empty for PETSc's own preconditioner
  LinearMap inverse_;
  std::exception_ptr failure_;
  ShellOperator shell_{&inverse_, &failure_};
  KSP ksp_ = nullptr;
  ::Vec b_ = nullptr, x_ = nullptr;
  bool rebuild_ = true;
  int most_iterations_ = 0;  // beyond this the preconditioner is outdated
  int built_ = 0;
};

}  // namespace couplet::linalg
