// SPDX-License-Identifier: Apache-2.0
#include "common/modes/largest_ratios.hpp"

#include <slepceps.h>

#include <algorithm>
#include <exception>
#include <numeric>

#include "common/base/error.hpp"
#include "common/linalg/petsc_shell.hpp"

namespace couplet::modes {
namespace {

constexpr double ratio_tolerance = 1e-9;
constexpr int most_ratio_restarts = 100;

struct RatioSolver {
  EPS eps = nullptr;
  Mat a = nullptr, b = nullptr;
  RatioSolver() = default;
  RatioSolver(const RatioSolver&) = delete;
  ~RatioSolver() {
    if (std::uncaught_exceptions() > 0) return;
    EPSDestroy(&eps);
    MatDestroy(&a);
    MatDestroy(&b);
  }
};

void set_up_ratios(RatioSolver& solver, linalg::ShellOperator& inverse, int n) {
  linalg::petsc_check(EPSSetOperators(solver.eps, solver.a, solver.b));
  linalg::petsc_check(EPSSetProblemType(solver.eps, EPS_GHEP));
  linalg::petsc_check(EPSSetType(solver.eps, EPSKRYLOVSCHUR));
  linalg::petsc_check(EPSSetWhichEigenpairs(solver.eps, EPS_LARGEST_REAL));
  linalg::petsc_check(EPSSetDimensions(solver.eps, n, PETSC_DEFAULT, PETSC_DEFAULT));
  linalg::petsc_check(EPSSetTolerances(solver.eps, ratio_tolerance, most_ratio_restarts));
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  linalg::petsc_check(EPSGetST(solver.eps, &st));
  linalg::petsc_check(STSetMatMode(st, ST_MATMODE_SHELL));
  linalg::petsc_check(STGetKSP(st, &ksp));
  linalg::petsc_check(KSPSetType(ksp, KSPPREONLY));
  linalg::petsc_check(KSPGetPC(ksp, &pc));
  linalg::petsc_check(PCSetType(pc, PCSHELL));
  linalg::petsc_check(PCShellSetContext(pc, &inverse));
  linalg::petsc_check(PCShellSetApply(pc, linalg::precondition_shell));
}

}  // namespace

Ratios largest_ratios(MPI_Comm comm, std::size_t n_owned, const RatioOperators& of, int n) {
  std::exception_ptr failure;
  linalg::ShellOperator a{&of.a, &failure}, b{&of.b, &failure}, inverse{&of.solve_b, &failure};
  RatioSolver solver;
  solver.a = linalg::symmetric_shell(comm, n_owned, a);
  solver.b = linalg::symmetric_shell(comm, n_owned, b);
  PetscInt rows = 0;
  linalg::petsc_check(MatGetSize(solver.a, &rows, nullptr));
  linalg::petsc_check(EPSCreate(comm, &solver.eps));
  set_up_ratios(solver, inverse, int(std::min<PetscInt>(n, rows)));
  linalg::petsc_check(EPSSolve(solver.eps));
  if (failure) std::rethrow_exception(failure);
  PetscInt found = 0;
  linalg::petsc_check(EPSGetConverged(solver.eps, &found));
  Ratios result;
  ::Vec x = nullptr;
  linalg::petsc_check(MatCreateVecs(solver.a, &x, nullptr));
  for (PetscInt i = 0; i < std::min<PetscInt>(found, n); ++i) {
    double value = 0;
    const double* entries = nullptr;
    linalg::petsc_check(EPSGetEigenpair(solver.eps, i, &value, nullptr, x, nullptr));
    linalg::petsc_check(VecGetArrayRead(x, &entries));
    result.value.push_back(value);
    result.shape.emplace_back(entries, entries + n_owned);
    linalg::petsc_check(VecRestoreArrayRead(x, &entries));
  }
  linalg::petsc_check(VecDestroy(&x));
  return result;
}

}  // namespace couplet::modes
