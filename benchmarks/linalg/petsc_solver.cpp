// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "benchmarks/linalg/meter.hpp"
#include "benchmarks/linalg/system.hpp"
#include "common/linalg/petsc.hpp"

namespace couplet::benchmark {

using namespace linalg;
namespace {

constexpr int most_starts = 8;
// Short solves [s] are repeated, because one is shorter than the resolution of the CPU clock.
constexpr int most_turns = 10;
constexpr double short_enough = 0.1;

double norm(MPI_Comm comm, const std::vector<double>& v) {
  double square = 0;
  for (const double x : v) square += x * x;
  return std::sqrt(parallel::sum(comm, square));
}

double true_residual(const System& system, const std::vector<double>& x) {
  std::vector<double> r(x.size());
  system.apply(x, r);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = system.b[i] - r[i];
  return norm(system.comm, r);
}

PetscErrorCode apply_map(const LinearMap& map, ::Vec x, ::Vec y) {
  const PetscScalar* from = nullptr;
  PetscScalar* to = nullptr;
  PetscInt n = 0;
  PetscCall(VecGetLocalSize(x, &n));
  PetscCall(VecGetArrayRead(x, &from));
  PetscCall(VecGetArrayWrite(y, &to));
  map({from, std::size_t(n)}, {to, std::size_t(n)});
  PetscCall(VecRestoreArrayWrite(y, &to));
  return VecRestoreArrayRead(x, &from);
}

PetscErrorCode apply_operator(Mat a, ::Vec x, ::Vec y) {
  void* map = nullptr;
  PetscCall(MatShellGetContext(a, &map));
  return apply_map(*static_cast<const LinearMap*>(map), x, y);
}

PetscErrorCode apply_inverse(PC pc, ::Vec x, ::Vec y) {
  void* map = nullptr;
  PetscCall(PCShellGetContext(pc, &map));
  return apply_map(*static_cast<const LinearMap*>(map), x, y);
}

Mat shell_of(const System& system) {
  Mat a = nullptr;
  const auto n = static_cast<PetscInt>(system.b.size());
  petsc_check(MatCreateShell(system.comm, n, n, PETSC_DETERMINE, PETSC_DETERMINE,
                             const_cast<LinearMap*>(&system.apply), &a));
  petsc_check(MatShellSetOperation(a, MATOP_MULT, reinterpret_cast<void (*)()>(apply_operator)));
  return a;
}

KSP make_solver(const System& system, Mat a, Mat p, const LinearMap& inverse, const std::string& options) {
  KSP ksp = nullptr;
  PC pc = nullptr;
  if (!a) a = shell_of(system);
  petsc_check(PetscOptionsInsertString(nullptr, options.c_str()));
  petsc_check(KSPCreate(system.comm, &ksp));
  petsc_check(KSPSetOperators(ksp, a, p ? p : a));
  petsc_check(KSPGetPC(ksp, &pc));
  if (!p) {
    petsc_check(PCSetType(pc, PCSHELL));
    petsc_check(PCShellSetContext(pc, const_cast<LinearMap*>(&inverse)));
    petsc_check(PCShellSetApply(pc, apply_inverse));
  }
  petsc_check(KSPSetTolerances(ksp, 1e-300, system.wanted, 1e100, 20000));
  petsc_check(KSPSetFromOptions(ksp));
  PetscBool direct = PETSC_FALSE;
  petsc_check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp), KSPPREONLY, &direct));
  petsc_check(KSPSetInitialGuessNonzero(ksp, direct ? PETSC_FALSE : PETSC_TRUE));
  return ksp;
}

/// Iterations. Restarts while the recurrence deviates from the true residual, at most `starts` times if > 0.
int solve_from_guess(const System& system, KSP ksp, ::Vec b, ::Vec x, int& starts) {
  int iterations = 0, done = 0;
  double left = INFINITY, before = INFINITY;
  PetscScalar* to = nullptr;
  petsc_check(VecGetArrayWrite(x, &to));
  std::ranges::copy(system.guess, to);
  petsc_check(VecRestoreArrayWrite(x, &to));
  for (; done < (starts > 0 ? starts : most_starts); ++done) {
    if (starts == 0 && done > 0) {
      left = true_residual(system, values_of(x));
      if (left <= system.wanted || !(left < 0.9 * before)) break;
      before = left;
    }
    petsc_check(KSPSolve(ksp, b, x));
    PetscInt n = 0;
    petsc_check(KSPGetIterationNumber(ksp, &n));
    iterations += static_cast<int>(n);
  }
  starts = done;
  return iterations;
}

}  // namespace

Result solve_by_petsc(const System& system, Mat a, Mat p, const LinearMap& inverse,
                      const std::string& options) {
  Result result;
  const Meter whole(system.comm);
  KSP ksp = make_solver(system, a, p, inverse, options);
  petsc_check(KSPSetUp(ksp));
  petsc_check(KSPSetUpOnBlocks(ksp));
  result.setup = whole.seconds();
  ::Vec b = vector_of(system.comm, system.b), x = vector_of(system.comm, system.guess);
  int starts = 0, turns = 0;
  result.iterations = solve_from_guess(system, ksp, b, x, starts);
  result.solve = whole.seconds() - result.setup;
  const double first = whole.seconds();
  for (; turns < most_turns && whole.seconds() - first < short_enough; ++turns)
    solve_from_guess(system, ksp, b, x, starts);
  if (result.solve < short_enough) result.solve = (whole.seconds() - first) / turns;
  result.x = values_of(x);
  result.megabytes = whole.peak();
  return result;
}

void print(const System& system, const Result& result, const std::string& note) {
  const double residual = true_residual(system, result.x) / system.wanted, size = norm(system.comm, system.b);
  double error = -1;
  if (!system.solution.empty()) {
    std::vector<double> difference = result.x;
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= system.solution[i];
    error = norm(system.comm, difference) / norm(system.comm, system.solution);
  }
  const GlobalIndex rows = parallel::sum(system.comm, GlobalIndex(system.b.size()));
  if (parallel::comm_rank(system.comm) == 0)
    fmt::print(
        "RESULT {{\"unknowns\": {}, \"iterations\": {}, \"setup\": {:.4g}, \"solve\": {:.4g}, "
        "\"megabytes\": {:.1f}, \"residual\": {:.3g}, \"tolerance\": {:.3g}, \"error\": {:.3g}, "
        "\"note\": \"{}\"}}\n",
        rows, result.iterations, result.setup, result.solve, result.megabytes, residual, system.wanted / size,
        error, note);
  std::fflush(stdout);
}

::Vec vector_of(MPI_Comm comm, const std::vector<double>& values) {
  ::Vec v = nullptr;
  petsc_check(VecCreateMPI(comm, static_cast<PetscInt>(values.size()), PETSC_DETERMINE, &v));
  PetscScalar* to = nullptr;
  petsc_check(VecGetArrayWrite(v, &to));
  std::ranges::copy(values, to);
  petsc_check(VecRestoreArrayWrite(v, &to));
  return v;
}

std::vector<double> values_of(::Vec v) {
  PetscInt n = 0;
  const PetscScalar* from = nullptr;
  petsc_check(VecGetLocalSize(v, &n));
  petsc_check(VecGetArrayRead(v, &from));
  std::vector<double> values(from, from + n);
  petsc_check(VecRestoreArrayRead(v, &from));
  return values;
}

std::vector<double> read_vector(MPI_Comm comm, const std::string& path, PetscInt rows) {
  PetscViewer file = nullptr;
  ::Vec v = nullptr;
  petsc_check(PetscViewerBinaryOpen(comm, path.c_str(), FILE_MODE_READ, &file));
  petsc_check(VecCreateMPI(comm, rows, PETSC_DETERMINE, &v));
  petsc_check(VecLoad(v, file));
  petsc_check(PetscViewerDestroy(&file));
  std::vector<double> values = values_of(v);
  petsc_check(VecDestroy(&v));
  return values;
}

void write_vector(MPI_Comm comm, const std::string& path, const std::vector<double>& values) {
  PetscViewer file = nullptr;
  ::Vec v = vector_of(comm, values);
  petsc_check(PetscViewerBinaryOpen(comm, path.c_str(), FILE_MODE_WRITE, &file));
  petsc_check(VecView(v, file));
  petsc_check(PetscViewerDestroy(&file));
  petsc_check(VecDestroy(&v));
}

}  // namespace couplet::benchmark
