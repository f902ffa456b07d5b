// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/linear_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "common/linalg/krylov.hpp"
#include "common/linalg/matrix.hpp"
#include "common/linalg/petsc.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/gathered_rows.hpp"

namespace couplet::linalg {
namespace {

bool is_direct(LinearMethod method) {
  return method == LinearMethod::direct || method == LinearMethod::direct_symmetric ||
         method == LinearMethod::direct_planar;
}

// New factors cost about as much as this many iterations save over a few dozen solves.
constexpr int most_with_old_factors = 8;

// PETSc's own factorization has no dense kernels. It is faster on small matrices (low overhead), MUMPS on
// large ones.
constexpr GlobalIndex largest_for_petsc = 12000;

void choose_petsc_factors(PC pc, bool symmetric) {
  petsc_check(PCSetType(pc, symmetric ? PCCHOLESKY : PCLU));
  petsc_check(PCFactorSetMatSolverType(pc, MATSOLVERPETSC));
  petsc_check(PCFactorSetMatOrderingType(pc, MATORDERINGND));
}

GlobalIndex rows_of(const SparseMatrix& matrix) {
  PetscInt rows = 0;
  petsc_check(MatGetSize(matrix.petsc(), &rows, nullptr));
  return rows;
}

void choose_factors(PC pc, const SparseMatrix& matrix, bool symmetric) {
  if (rows_of(matrix) <= largest_for_petsc) return choose_petsc_factors(pc, symmetric);
  petsc_check(PCSetType(pc, symmetric ? PCCHOLESKY : PCLU));
  petsc_check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

/// Factors of a small matrix on every rank. They have less latency than a distributed solve and give reproducible bits,
/// whereas MUMPS sums in order of message arrival.
class FactorsEverywhere {
 public:
  FactorsEverywhere(std::string what, const SparseMatrix& matrix, bool symmetric)
      : what_(std::move(what)),
        matrix_(matrix),
        rows_(matrix.comm(), static_cast<Index>(matrix.n_owned_rows()), sizeof(double)),
        right_(rows_.count()),
        left_(rows_.count()) {
    petsc_check(PCCreate(PETSC_COMM_SELF, &pc_));
    choose_petsc_factors(pc_, symmetric);
    petsc_check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, rows_.count(), right_.data(), &b_));
    petsc_check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, rows_.count(), left_.data(), &x_));
  }
  ~FactorsEverywhere() {
    PCDestroy(&pc_);
    MatDestroy(&whole_);
    VecDestroy(&b_);
    VecDestroy(&x_);
  }
  FactorsEverywhere(const FactorsEverywhere&) = delete;
  FactorsEverywhere& operator=(const FactorsEverywhere&) = delete;

  /// Factorizes the current values. Throws SolveFailure. Collective.
  void factorise() {
    petsc_check(MatCreateRedundantMatrix(matrix_.petsc(), parallel::comm_size(matrix_.comm()), MPI_COMM_NULL,
                                         whole_ ? MAT_REUSE_MATRIX : MAT_INITIAL_MATRIX, &whole_));
    petsc_check(PCSetOperators(pc_, whole_, whole_));
    petsc_check(PCSetUp(pc_));
    PCFailedReason reason = PC_NOERROR;
    petsc_check(PCGetFailedReason(pc_, &reason));
    if (reason != PC_NOERROR)
      throw SolveFailure("The matrix of {} could not be factorized: {}.", what_, PCFailedReasons[reason]);
  }
  /// Collective.
  void solve(std::span<const double> b, std::span<double> x) {
    rows_.gather(b.data(), right_.data());
    petsc_check(PCApply(pc_, b_, x_));
    std::copy_n(left_.begin() + rows_.first(), x.size(), x.begin());
  }

 private:
  std::string what_;
  const SparseMatrix& matrix_;
  parallel::GatheredRows rows_;
  std::vector<double> right_, left_;  // b_ and x_
  Mat whole_ = nullptr;
  PC pc_ = nullptr;
  ::Vec b_ = nullptr, x_ = nullptr;
};

// Smoothed aggregation with one symmetric SOR sweep, the best packaged preconditioner for FV Laplacians: ML or, in
// builds of PETSc without it (Debian 13), GAMG. Setups must not depend on earlier ones, or a restarted run would
// not be reproducible: the matrix norm bounds the spectral radius in ML's prolongation smoother, whose other
// estimate uses random vectors that continue from setup to setup (2 % more iterations on the thin plate's fluid),
// and GAMG must not keep the interpolation of its first matrix.
void choose_aggregation(PC pc) {
#ifdef PETSC_HAVE_ML
  petsc_check(PCSetType(pc, PCML));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_sa_pc_ml_SpectralNormScheme_Anorm", "true"));
#else
  petsc_check(PCSetType(pc, PCGAMG));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_sa_pc_gamg_reuse_interpolation", "false"));
#endif
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_sa_mg_levels_ksp_type", "richardson"));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_sa_mg_levels_ksp_max_it", "1"));
  petsc_check(PetscOptionsSetValue(nullptr, "-couplet_sa_mg_levels_pc_type", "sor"));
  petsc_check(PCSetOptionsPrefix(pc, "couplet_sa_"));
  petsc_check(PCSetFromOptions(pc));
}

/// Selects CHOLMOD's simplicial LDL^T, whose triangular solves cost a seventh of MUMPS's on a 2-D mesh. The
/// supernodal form factorizes faster but solves more slowly with such thin supernodes.
void choose_cholmod(PC pc) {
  petsc_check(PetscOptionsSetValue(nullptr, "-mat_cholmod_supernodal_switch", "1e10"));
  petsc_check(PCSetType(pc, PCCHOLESKY));
  petsc_check(PCFactorSetMatSolverType(pc, MATSOLVERCHOLMOD));
}

/// Sets the Krylov method and preconditioner of a LinearMethod.
void choose_method(KSP ksp, PC pc, const SparseMatrix& matrix, LinearMethod method) {
  switch (method) {
    case LinearMethod::direct:
    case LinearMethod::direct_symmetric:
      petsc_check(KSPSetType(ksp, KSPPREONLY));
      return choose_factors(pc, matrix, method == LinearMethod::direct_symmetric);
    case LinearMethod::direct_planar:
      petsc_check(KSPSetType(ksp, KSPPREONLY));
      return parallel::comm_size(matrix.comm()) == 1 ? choose_cholmod(pc) : choose_factors(pc, matrix, true);
    case LinearMethod::cg_direct:
      petsc_check(KSPSetType(ksp, KSPCG));
      petsc_check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
      // With one unknown per cell, a fluid step takes 0.84 of CHOLMOD's time and a fifth of that of MUMPS.
      return parallel::comm_size(matrix.comm()) == 1 ? choose_petsc_factors(pc, true)
                                                     : choose_factors(pc, matrix, true);
    case LinearMethod::cg_multigrid:
      petsc_check(KSPSetType(ksp, KSPCG));
      petsc_check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
      return choose_aggregation(pc);
    case LinearMethod::gmres_multigrid:
      petsc_check(KSPSetType(ksp, KSPGMRES));
      petsc_check(KSPSetPCSide(ksp, PC_RIGHT));
      petsc_check(PCSetType(pc, PCHYPRE));
      petsc_check(PCHYPRESetType(pc, "boomeramg"));
      return;
    case LinearMethod::bicgstab_ilu:
      petsc_check(KSPSetType(ksp, KSPPREONLY));  // KrylovSolver iterates
      petsc_check(PCSetType(pc, PCBJACOBI));
      return;
    case LinearMethod::cg_icc:
      petsc_check(KSPSetType(ksp, KSPCG));
      petsc_check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
      petsc_check(PCSetType(pc, PCBJACOBI));
      petsc_check(PetscOptionsSetValue(nullptr, "-couplet_icc_sub_pc_type", "icc"));
      petsc_check(PCSetOptionsPrefix(pc, "couplet_icc_"));
      petsc_check(PCSetFromOptions(pc));
      return;
  }
}

PetscErrorCode sign_of_life(KSP, PetscInt, PetscReal, void*) {
  log::alive();
  return 0;
}

}  // namespace

LinearSolver::LinearSolver(std::string what, const SparseMatrix& matrix, const LinearOptions& options)
    : what_(std::move(what)), options_(options), matrix_(&matrix) {
  petsc_check(KSPCreate(matrix.comm(), &ksp_));
  petsc_check(KSPMonitorSet(ksp_, sign_of_life, nullptr, nullptr));
  petsc_check(KSPSetOperators(ksp_, matrix.petsc(), matrix.petsc()));
  PC pc = nullptr;
  petsc_check(KSPGetPC(ksp_, &pc));
  choose_method(ksp_, pc, matrix, options.method);
  if ((is_direct(options.method) || options.method == LinearMethod::cg_direct) &&
      parallel::comm_size(matrix.comm()) > 1 && rows_of(matrix) <= largest_for_petsc) {
    const auto factors =
        std::make_shared<FactorsEverywhere>(what_, matrix, options.method != LinearMethod::direct);
    set_preconditioner([factors] {
      factors->factorise();
      return [factors](std::span<const double> r, std::span<double> z) { factors->solve(r, z); };
    });
  }
  if (options.as_preconditioner) petsc_check(KSPSetNormType(ksp_, KSP_NORM_NONE));
  if (!is_direct(options.method)) petsc_check(KSPSetInitialGuessNonzero(ksp_, PETSC_TRUE));
  petsc_check(MatCreateVecs(matrix.petsc(), &x_, &b_));
  if (options.method != LinearMethod::bicgstab_ilu) return;
  const auto apply = [this](std::span<const double> from, std::span<double> to) {
    matrix_->multiply(from, to);
  };
  const auto precondition = [this, pc](std::span<const double> from, std::span<double> to) {
    petsc_check(VecPlaceArray(b_, from.data()));
    petsc_check(VecPlaceArray(x_, to.data()));
    petsc_check(PCApply(pc, b_, x_));
    petsc_check(VecResetArray(b_));
    petsc_check(VecResetArray(x_));
  };
  krylov_ = std::make_unique<KrylovSolver>(what_, matrix.comm(), matrix.n_owned_rows(), apply, precondition);
}

LinearSolver::~LinearSolver() {
  if (!ksp_ || std::uncaught_exceptions() > 0) return;  // collective: not during unwinding
  KSPDestroy(&ksp_);
  VecDestroy(&b_);
  VecDestroy(&x_);
}

void LinearSolver::matrix_changed() {
  if (is_direct(options_.method)) rebuild_ = true;
}

void LinearSolver::refresh() { rebuild_ = true; }

void LinearSolver::set_preconditioner(std::function<LinearMap()> make) {
  make_ = std::move(make);
  PC pc = nullptr;
  petsc_check(KSPGetPC(ksp_, &pc));
  petsc_check(PCSetType(pc, PCSHELL));
  petsc_check(PCShellSetContext(pc, &shell_));
  petsc_check(PCShellSetApply(pc, precondition_shell));
}

void LinearSolver::make_preconditioner() {
  if (make_) inverse_ = make_();
  petsc_check(KSPSetReusePreconditioner(ksp_, PETSC_FALSE));
  petsc_check(KSPSetOperators(ksp_, matrix_->petsc(), matrix_->petsc()));
  const log::LongWork work;  // factorization may take long without a sign of life
  petsc_check(KSPSetUp(ksp_));
}

void LinearSolver::restore(const PreconditionerMemory& memory) {
  rebuild_ = memory.is_due;
  most_iterations_ = memory.most_iterations;
  if (!rebuild_) make_preconditioner();
}

SolveStatistics LinearSolver::solve(std::span<const double> b, std::span<double> x) {
  return solve(b, x, options_.relative_tolerance, options_.absolute_tolerance);
}

SolveStatistics LinearSolver::solve(std::span<const double> b, std::span<double> x, double relative_tolerance,
                                    double absolute_tolerance) {
  const auto start = std::chrono::steady_clock::now();
  SolveStatistics statistics;
  KSPConvergedReason reason = attempt(b, x, relative_tolerance, absolute_tolerance, statistics);
  if (reason < 0 && !rebuild_) {
    // The kept preconditioner no longer fits the matrix, so the solve is repeated with a new one.
    rebuild_ = true;
    std::fill(x.begin(), x.end(), 0.0);
    reason = attempt(b, x, relative_tolerance, absolute_tolerance, statistics);
  }
  if (reason < 0)
    throw SolveFailure("The linear solver for {} did not converge: {} after {} iterations, residual {:.3e}.",
                       what_, KSPConvergedReasons[reason], statistics.iterations, statistics.residual);
  if (rebuild_) {
    rebuild_ = false;
    ++built_;
    most_iterations_ =
        options_.method == LinearMethod::cg_direct ? most_with_old_factors : 2 * statistics.iterations + 2;
  } else if (!is_direct(options_.method) && statistics.iterations > most_iterations_) {
    rebuild_ = true;
  }
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

double LinearSolver::norm(std::span<const double> values) const {
  return std::sqrt(parallel::sum(matrix_->comm(), dot_here(values, values)));
}

double LinearSolver::true_residual(std::span<const double> b, std::span<const double> x) const {
  std::vector<double> residual(b.size());
  matrix_->multiply(x, residual);
  for (std::size_t i = 0; i < b.size(); ++i) residual[i] = b[i] - residual[i];
  return norm(residual);
}

/// Performs one solve. A result that is not finite counts as not converged.
KSPConvergedReason LinearSolver::attempt(std::span<const double> b, std::span<double> x,
                                         double relative_tolerance, double absolute_tolerance,
                                         SolveStatistics& statistics) {
  if (rebuild_)
    make_preconditioner();
  else
    petsc_check(KSPSetReusePreconditioner(ksp_, PETSC_TRUE));
  if (krylov_) {
    try {
      statistics = krylov_->solve(b, x,
                                  {relative_tolerance, options_.max_iterations, false, false, 0,
                                   absolute_tolerance, (options_.max_iterations + 1) / 2});
      return KSP_CONVERGED_RTOL;
    } catch (const SolveFailure&) {
      if (rebuild_) throw;
      return KSP_DIVERGED_ITS;
    }
  }
  petsc_check(
      KSPSetTolerances(ksp_, relative_tolerance, absolute_tolerance, PETSC_DEFAULT, options_.max_iterations));
  petsc_check(VecPlaceArray(b_, b.data()));
  petsc_check(VecPlaceArray(x_, x.data()));
  const PetscErrorCode code = KSPSolve(ksp_, b_, x_);
  PetscReal norm = 0;
  if (code == 0) petsc_check(VecNorm(x_, NORM_2, &norm));
  petsc_check(VecResetArray(b_));
  petsc_check(VecResetArray(x_));
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  petsc_check(code);
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  petsc_check(KSPGetConvergedReason(ksp_, &reason));
  petsc_check(KSPGetIterationNumber(ksp_, &iterations));
  petsc_check(KSPGetResidualNorm(ksp_, &statistics.residual));
  statistics.iterations += static_cast<int>(iterations);
  return std::isfinite(norm) ? reason : std::min(reason, KSP_DIVERGED_NANORINF);
}

}  // namespace couplet::linalg
