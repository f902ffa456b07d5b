// SPDX-License-Identifier: Apache-2.0
#include "common/modes/largest_ratios.hpp"

#include <slepceps.h>

#include <algorithm>
#include <exception>
#include <numeric>

#include "common/base/error.hpp"
#include "common/modes/shell_operator.hpp"

namespace couplet {
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

void set_up_ratios(RatioSolver& solver, ShellOperator& inverse, int n) {
  petsc_check(EPSSetOperators(solver.eps, solver.a, solver.b));
  petsc_check(EPSSetProblemType(solver.eps, EPS_GHEP));
  petsc_check(EPSSetType(solver.eps, EPSKRYLOVSCHUR));
  petsc_check(EPSSetWhichEigenpairs(solver.eps, EPS_LARGEST_REAL));
  petsc_check(EPSSetDimensions(solver.eps, n, PETSC_DEFAULT, PETSC_DEFAULT));
  petsc_check(EPSSetTolerances(solver.eps, ratio_tolerance, most_ratio_restarts));
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  petsc_check(EPSGetST(solver.eps, &st));
  petsc_check(STSetMatMode(st, ST_MATMODE_SHELL));
  petsc_check(STGetKSP(st, &ksp));
  petsc_check(KSPSetType(ksp, KSPPREONLY));
  petsc_check(KSPGetPC(ksp, &pc));
  petsc_check(PCSetType(pc, PCSHELL));
  petsc_check(PCShellSetContext(pc, &inverse));
  petsc_check(PCShellSetApply(pc, precondition_shell));
}

}  // namespace

Ratios largest_ratios(MPI_Comm comm, std::size_t n_owned, const RatioOperators& of, int n) {
  std::exception_ptr failure;
  ShellOperator a{&of.a, &failure}, b{&of.b, &failure}, inverse{&of.solve_b, &failure};
  RatioSolver solver;
  solver.a = symmetric_shell(comm, n_owned, a);
  solver.b = symmetric_shell(comm, n_owned, b);
  PetscInt rows = 0;
  petsc_check(MatGetSize(solver.a, &rows, nullptr));
  petsc_check(EPSCreate(comm, &solver.eps));
  set_up_ratios(solver, inverse, int(std::min<PetscInt>(n, rows)));
  petsc_check(EPSSolve(solver.eps));
  if (failure) std::rethrow_exception(failure);
  PetscInt found = 0;
  petsc_check(EPSGetConverged(solver.eps, &found));
  Ratios result;
  ::Vec x = nullptr;
  petsc_check(MatCreateVecs(solver.a, &x, nullptr));
  for (PetscInt i = 0; i < std::min<PetscInt>(found, n); ++i) {
    double value = 0;
    const double* entries = nullptr;
    petsc_check(EPSGetEigenpair(solver.eps, i, &value, nullptr, x, nullptr));
    petsc_check(VecGetArrayRead(x, &entries));
    result.value.push_back(value);
    result.shape.emplace_back(entries, entries + n_owned);
    petsc_check(VecRestoreArrayRead(x, &entries));
  }
  petsc_check(VecDestroy(&x));
  return result;
}

}  // namespace couplet
