// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/linear_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include "common/linalg/petsc_check.hpp"
#include "common/linalg/petsc_methods.hpp"
#include "common/linalg/petsc_shell.hpp"
#include "common/linalg/single_factors.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

bool is_direct(LinearMethod method) {
  return method == LinearMethod::direct || method == LinearMethod::direct_symmetric ||
         method == LinearMethod::direct_planar;
}

// Fresh factors cost about as much as this many iterations save over a few dozen solves.
constexpr int most_with_old_factors = 8;

// Fresh factors in double precision need one iteration, two at very tight tolerances: more than this many
// with factors in single precision mean that cells are too thin for them.
constexpr int most_with_fresh_single_factors = 6;

// Of BiCGStab from its true residual.
constexpr int most_restarts = 20;

PetscErrorCode apply_single(PC pc, ::Vec b, ::Vec x) {
  void* factors = nullptr;
  PetscCall(PCShellGetContext(pc, &factors));
  const PetscScalar* from = nullptr;
  PetscScalar* to = nullptr;
  PetscInt n = 0;
  PetscCall(VecGetLocalSize(b, &n));
  PetscCall(VecGetArrayRead(b, &from));
  PetscCall(VecGetArrayWrite(x, &to));
  static_cast<SingleFactors*>(factors)->apply({from, std::size_t(n)}, {to, std::size_t(n)});
  PetscCall(VecRestoreArrayWrite(x, &to));
  return VecRestoreArrayRead(b, &from);
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
  if (options.as_preconditioner) petsc_check(KSPSetNormType(ksp_, KSP_NORM_NONE));
  if (options.method == LinearMethod::cg_single && parallel::comm_size(matrix.comm()) == 1)
    use_single_precision();
  if (!is_direct(options.method)) petsc_check(KSPSetInitialGuessNonzero(ksp_, PETSC_TRUE));
  petsc_check(MatCreateVecs(matrix.petsc(), &x_, &b_));
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

void LinearSolver::use_single_precision() {
  PC pc = nullptr;
  petsc_check(KSPGetPC(ksp_, &pc));
  single_ = std::make_unique<SingleFactors>();
  petsc_check(PCSetType(pc, PCSHELL));
  petsc_check(PCShellSetContext(pc, single_.get()));
  petsc_check(PCShellSetApply(pc, apply_single));
}

void LinearSolver::make_single_factors() {
  PetscInt n = 0;
  const PetscInt *offset = nullptr, *index = nullptr;
  const PetscScalar* value = nullptr;
  PetscBool done = PETSC_FALSE;
  petsc_check(MatGetRowIJ(matrix_->petsc(), 0, PETSC_FALSE, PETSC_FALSE, &n, &offset, &index, &done));
  petsc_check(MatSeqAIJGetArrayRead(matrix_->petsc(), &value));
  const std::vector<int> offsets(offset, offset + n + 1), indices(index, index + offset[n]);
  const auto release = [&] {
    petsc_check(MatSeqAIJRestoreArrayRead(matrix_->petsc(), &value));
    petsc_check(MatRestoreRowIJ(matrix_->petsc(), 0, PETSC_FALSE, PETSC_FALSE, &n, &offset, &index, &done));
  };
  try {
    single_->factorise(offsets, indices, {value, indices.size()});
  } catch (...) {
    release();
    throw;
  }
  release();
}

void LinearSolver::leave_single_precision() {
  PC pc = nullptr;
  petsc_check(KSPGetPC(ksp_, &pc));
  choose_cholmod(pc);
  single_.reset();
}

void LinearSolver::refresh() { rebuild_ = true; }

/// By PETSc when it next sets up, of the operators it is given here.
void LinearSolver::make_preconditioner() {
  if (single_) make_single_factors();
  petsc_check(KSPSetReusePreconditioner(ksp_, PETSC_FALSE));
  petsc_check(KSPSetOperators(ksp_, matrix_->petsc(), matrix_->petsc()));
}

void LinearSolver::restore(const PreconditionerMemory& memory) {
  if (single_ && !memory.is_single) leave_single_precision();
  if (!single_ && memory.is_single) use_single_precision();
  rebuild_ = memory.is_due;
  most_iterations_ = memory.most_iterations;
  if (rebuild_) return;
  make_preconditioner();
  petsc_check(KSPSetUp(ksp_));
}

SolveStatistics LinearSolver::solve(std::span<const double> b, std::span<double> x) {
  return solve(b, x, options_.relative_tolerance, options_.absolute_tolerance);
}

SolveStatistics LinearSolver::solve(std::span<const double> b, std::span<double> x, double relative_tolerance,
                                    double absolute_tolerance) {
  const auto start = std::chrono::steady_clock::now();
  // BiCGStab leaves half of the iterations to GMRES.
  const int most = options_.method == LinearMethod::bicgstab_ilu ? (options_.max_iterations + 1) / 2
                                                                 : options_.max_iterations;
  petsc_check(KSPSetTolerances(ksp_, relative_tolerance, absolute_tolerance, PETSC_DEFAULT, most));
  SolveStatistics statistics;
  KSPConvergedReason reason = attempt(b, x, statistics);
  if (reason < 0 && (!rebuild_ || single_)) {
    // The kept preconditioner no longer fits the matrix: one more try with a fresh one.
    if (rebuild_) leave_single_precision();
    rebuild_ = true;
    std::fill(x.begin(), x.end(), 0.0);
    reason = attempt(b, x, statistics);
  }
  // The residual that BiCGStab carries along drifts from the true one: start again from where it got to.
  if (reason > 0 && options_.method == LinearMethod::bicgstab_ilu) {
    const double wanted = std::max(relative_tolerance * norm(b), absolute_tolerance);
    for (int restart = 0; reason > 0 && (statistics.residual = true_residual(b, x)) > 2 * wanted; ++restart)
      reason = restart < most_restarts ? attempt(b, x, statistics) : KSP_DIVERGED_BREAKDOWN;
  }
  if (reason < 0 && options_.method == LinearMethod::bicgstab_ilu)
    reason = continue_by_gmres(b, x, std::max(relative_tolerance * norm(b), absolute_tolerance), statistics);
  if (reason < 0)
    throw SolveFailure("The linear solver for {} did not converge: {} after {} iterations, residual {:.3e}.",
                       what_, KSPConvergedReasons[reason], statistics.iterations, statistics.residual);
  if (rebuild_) {
    rebuild_ = false;
    ++built_;
    const bool factors =
        options_.method == LinearMethod::cg_direct || options_.method == LinearMethod::cg_single;
    most_iterations_ = factors ? most_with_old_factors : 2 * statistics.iterations + 2;
    if (single_ && statistics.iterations > most_with_fresh_single_factors) {
      leave_single_precision();
      rebuild_ = true;
    }
  } else if (!is_direct(options_.method) && statistics.iterations > most_iterations_) {
    rebuild_ = true;
  }
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

double LinearSolver::norm(std::span<const double> values) const {
  double square = 0;
  for (const double v : values) square += v * v;
  return std::sqrt(parallel::sum(matrix_->comm(), square));
}

double LinearSolver::true_residual(std::span<const double> b, std::span<const double> x) const {
  std::vector<double> residual(b.size());
  matrix_->multiply(x, residual);
  for (std::size_t i = 0; i < b.size(); ++i) residual[i] = b[i] - residual[i];
  return norm(residual);
}

/// Where BiCGStab has broken down or is slow: from its guess if that is nearer, with the same preconditioner.
KSPConvergedReason LinearSolver::continue_by_gmres(std::span<const double> b, std::span<double> x,
                                                   double wanted, SolveStatistics& statistics) {
  const auto apply = [&](std::span<const double> from, std::span<double> to) { matrix_->multiply(from, to); };
  const auto precondition = [&](std::span<const double> from, std::span<double> to) {
    petsc_check(VecPlaceArray(b_, from.data()));
    petsc_check(VecPlaceArray(x_, to.data()));
    PC pc = nullptr;
    petsc_check(KSPGetPC(ksp_, &pc));
    petsc_check(PCApply(pc, b_, x_));
    petsc_check(VecResetArray(b_));
    petsc_check(VecResetArray(x_));
  };
  if (!(true_residual(b, x) < norm(b))) std::fill(x.begin(), x.end(), 0.0);
  std::vector<double> r(b.size());
  PetscGmres gmres(matrix_->comm(), b.size(), apply, precondition);
  const int most = 2 * (options_.max_iterations - statistics.iterations);
  if (most > 0)
    log::info("{}: BiCGStab stopped after {} iterations; GMRES continues", what_, statistics.iterations);
  int applications = 0, before = -1;
  while (applications < most && applications > before) {
    before = applications;
    matrix_->multiply(x, r);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
    statistics.residual = norm(r);
    if (statistics.residual <= wanted) break;
    applications += gmres.run(r, x, wanted, most - applications);
  }
  statistics.residual = true_residual(b, x);
  statistics.iterations += (applications + 1) / 2;
  total_iterations_ += (applications + 1) / 2;
  if (statistics.residual <= 2 * wanted) return KSP_CONVERGED_RTOL;
  return applications >= most ? KSP_DIVERGED_ITS : KSP_DIVERGED_BREAKDOWN;
}

namespace {

/// Setting up, which may factorise for long without a sign of life, and the iterations, each of which is one.
PetscErrorCode solve_alive(KSP ksp, ::Vec b, ::Vec x, bool sets_up) {
  if (sets_up) {
    const log::LongWork work;
    if (const PetscErrorCode code = KSPSetUp(ksp); code != 0) return code;
  }
  return KSPSolve(ksp, b, x);
}

}  // namespace

/// One KSPSolve; a result that is not finite counts as not converged.
KSPConvergedReason LinearSolver::attempt(std::span<const double> b, std::span<double> x,
                                         SolveStatistics& statistics) {
  if (rebuild_)
    make_preconditioner();
  else
    petsc_check(KSPSetReusePreconditioner(ksp_, PETSC_TRUE));
  petsc_check(VecPlaceArray(b_, b.data()));
  petsc_check(VecPlaceArray(x_, x.data()));
  const PetscErrorCode code = solve_alive(ksp_, b_, x_, rebuild_);
  PetscReal norm = 0;
  if (code == 0) petsc_check(VecNorm(x_, NORM_2, &norm));
  petsc_check(VecResetArray(b_));
  petsc_check(VecResetArray(x_));
  petsc_check(code);
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  petsc_check(KSPGetConvergedReason(ksp_, &reason));
  petsc_check(KSPGetIterationNumber(ksp_, &iterations));
  petsc_check(KSPGetResidualNorm(ksp_, &statistics.residual));
  statistics.iterations += static_cast<int>(iterations);
  total_iterations_ += static_cast<int>(iterations);
  return std::isfinite(norm) ? reason : std::min(reason, KSP_DIVERGED_NANORINF);
}

}  // namespace couplet::linalg
