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
  direct,            ///< LU: PETSc's own for small matrices (whole on every rank), else MUMPS
  direct_symmetric,  ///< Cholesky: the same
  direct_planar,     ///< Cholesky of a 2-D mesh's matrix, positive definite: on one rank by CHOLMOD
  cg_direct,     ///< CG with kept Cholesky factors, on one rank PETSc's own: 2-D, symmetric positive definite
  cg_multigrid,  ///< CG with smoothed aggregation (ML), symmetric SOR
  gmres_multigrid,  ///< GMRES with BoomerAMG
  bicgstab_ilu,     ///< KrylovSolver's BiCGStab and GMRES with ILU(0), block Jacobi over the ranks
  cg_icc,           ///< CG with incomplete Cholesky factors, block Jacobi over the ranks
};

class KrylovSolver;

struct LinearOptions {
  LinearMethod method = LinearMethod::cg_multigrid;
  double relative_tolerance = 1e-8;   ///< of |r| / |b|
  double absolute_tolerance = 1e-50;  ///< of |r|; may also be given with each solve
  int max_iterations = 500;
  /// Of a direct method: nobody asks for its residual, which is a product more.
  bool as_preconditioner = false;
};

struct SolveStatistics {
  int iterations = 0;
  int inner_iterations = 0;  ///< of solves within an iteration; 0: there are none
  double residual = 0;
  double seconds = 0;
};

/// What a solver remembers of its preconditioner but for the matrix it was made from. With that matrix it can be
/// made again bit for bit: a run that goes on from a checkpoint has the preconditioner that it had.
struct PreconditionerMemory {
  bool is_due = true;  ///< made anew at the next solve
  int most_iterations = 0;
  bool operator==(const PreconditionerMemory&) const = default;
};

/// A Krylov or direct solver whose preconditioner is kept until it is told to refresh.
class LinearSolver {
 public:
  /// `what` names the unknown in error messages, e.g. "pressure".
  LinearSolver(std::string what, const SparseMatrix& matrix, const LinearOptions& options);
  ~LinearSolver();
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// Solves A x = b on the owned rows; x holds the initial guess on entry. Throws SolveFailure with the name
  /// and PETSc's reason if it did not converge or the result is not finite. Collective.
  SolveStatistics solve(std::span<const double> b, std::span<double> x);
  SolveStatistics solve(std::span<const double> b, std::span<double> x, double relative_tolerance,
                        double absolute_tolerance);
  /// The matrix values changed: direct methods factorise again at the next solve; Krylov methods keep their
  /// preconditioner while iterations stay below twice (plus 2) those seen right after it was made, and make
  /// it anew when it fails.
  void matrix_changed();
  /// Takes what `make` gives for its preconditioner, whenever that is due.
  void set_preconditioner(std::function<LinearMap()> make);
  /// Builds the preconditioner anew at the next solve.
  void refresh();
  PreconditionerMemory memory() const { return {rebuild_, most_iterations_}; }
  /// Makes the preconditioner now, of the matrix as it stands: the one that `memory` goes with. Collective.
  void restore(const PreconditionerMemory& memory);
  int preconditioners_built() const { return built_; }
  /// |v| over all ranks. Collective.
  double norm(std::span<const double> values) const;
  /// |b - A x|. Collective.
  double true_residual(std::span<const double> b, std::span<const double> x) const;

 private:
  void make_preconditioner();
  KSPConvergedReason attempt(std::span<const double> b, std::span<double> x, double relative_tolerance,
                             double absolute_tolerance, SolveStatistics& statistics);

  std::string what_;
  LinearOptions options_;
  const SparseMatrix* matrix_;
  std::unique_ptr<KrylovSolver> krylov_;  // of bicgstab_ilu
  std::function<LinearMap()> make_;       // empty: PETSc's own preconditioner
  LinearMap inverse_;
  std::exception_ptr failure_;
  ShellOperator shell_{&inverse_, &failure_};
  KSP ksp_ = nullptr;
  ::Vec b_ = nullptr, x_ = nullptr;
  bool rebuild_ = true;
  int most_iterations_ = 0;  // above: the preconditioner has aged
  int built_ = 0;
};

}  // namespace couplet::linalg
