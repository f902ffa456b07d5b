// SPDX-License-Identifier: Apache-2.0
#include "common/modes/lowest_modes.hpp"

#include <slepceps.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

#include "common/base/error.hpp"
#include "common/linalg/petsc_check.hpp"

namespace couplet::modes {
namespace {

/// Modes asked for beyond those wanted: room to place the shift of the count between two eigenvalues.
constexpr int extra = 4;
constexpr double tolerance = 1e-12;  // of the eigenvalues of the inverse

struct Solver {
  EPS eps = nullptr;
  Solver() = default;
  Solver(const Solver&) = delete;
  ~Solver() {
    if (eps && std::uncaught_exceptions() == 0) EPSDestroy(&eps);
  }
};

struct Matrix {
  Mat mat = nullptr;
  Matrix() = default;
  Matrix(const Matrix&) = delete;
  ~Matrix() {
    if (mat && std::uncaught_exceptions() == 0) MatDestroy(&mat);
  }
};

void set_up(EPS eps, Mat k, Mat m, int n, double shift) {
  linalg::petsc_check(EPSSetOperators(eps, k, m));
  linalg::petsc_check(EPSSetProblemType(eps, EPS_GHEP));
  linalg::petsc_check(EPSSetType(eps, EPSKRYLOVSCHUR));
  linalg::petsc_check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  linalg::petsc_check(EPSSetTarget(eps, shift));
  linalg::petsc_check(EPSSetDimensions(eps, n, PETSC_DEFAULT, PETSC_DEFAULT));
  linalg::petsc_check(EPSSetTolerances(eps, tolerance, 500));
  ST st = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  linalg::petsc_check(EPSGetST(eps, &st));
  linalg::petsc_check(STSetType(st, STSINVERT));
  linalg::petsc_check(STGetKSP(st, &ksp));
  linalg::petsc_check(KSPSetType(ksp, KSPPREONLY));
  linalg::petsc_check(KSPGetPC(ksp, &pc));
  linalg::petsc_check(PCSetType(pc, PCCHOLESKY));
  linalg::petsc_check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

/// Number of eigenvalues below `s`: negative pivots of K - s M.
PetscInt count_below(Mat k, Mat m, double s) {
  Matrix shifted, factor;
  linalg::petsc_check(MatDuplicate(k, MAT_COPY_VALUES, &shifted.mat));
  linalg::petsc_check(MatAXPY(shifted.mat, -s, m, UNKNOWN_NONZERO_PATTERN));
  linalg::petsc_check(MatSetOption(shifted.mat, MAT_SYMMETRIC, PETSC_TRUE));
  linalg::petsc_check(MatGetFactor(shifted.mat, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &factor.mat));
  linalg::petsc_check(MatMumpsSetIcntl(factor.mat, 24, 1));  // the count asks for it
  MatFactorInfo info;
  linalg::petsc_check(MatFactorInfoInitialize(&info));
  linalg::petsc_check(MatCholeskyFactorSymbolic(factor.mat, shifted.mat, nullptr, &info));
  linalg::petsc_check(MatCholeskyFactorNumeric(factor.mat, shifted.mat, &info));
  PetscInt negative = 0, zero = 0, positive = 0;
  linalg::petsc_check(MatGetInertia(factor.mat, &negative, &zero, &positive));
  return negative;
}

/// How many modes end at the widest relative gap among the last ones, at least `n`.
int widest_gap(const std::vector<double>& values, int n, double shift) {
  int best = n;
  double widest = -1;
  for (int i = n; i < static_cast<int>(values.size()); ++i) {
    const double gap = (values[i] - values[i - 1]) / (values[i] - shift);
    if (gap > widest) widest = gap, best = i;
  }
  return best;
}

/// All converged pairs, ascending; the shapes as PETSc gives them (x . M x = 1).
EigenModes converged(EPS eps, const linalg::SparseMatrix& matrix) {
  PetscInt n = 0;
  linalg::petsc_check(EPSGetConverged(eps, &n));
  std::vector<std::pair<double, std::vector<double>>> pairs;
  ::Vec x = nullptr;
  linalg::petsc_check(MatCreateVecs(matrix.petsc(), &x, nullptr));
  double worst = 0;
  for (PetscInt i = 0; i < n; ++i) {
    double value = 0, residual = 0;
    linalg::petsc_check(EPSGetEigenpair(eps, i, &value, nullptr, x, nullptr));
    linalg::petsc_check(EPSComputeError(eps, i, EPS_ERROR_BACKWARD, &residual));
    worst = std::max(worst, residual);
    const double* values = nullptr;
    linalg::petsc_check(VecGetArrayRead(x, &values));
    pairs.emplace_back(value, std::vector<double>(values, values + matrix.n_owned_rows()));
    linalg::petsc_check(VecRestoreArrayRead(x, &values));
  }
  linalg::petsc_check(VecDestroy(&x));
  std::ranges::stable_sort(pairs, {}, [](const auto& pair) { return pair.first; });
  EigenModes modes;
  modes.worst_residual = worst;
  for (auto& [value, shape] : pairs) {
    modes.eigenvalue.push_back(value);
    modes.shape.push_back(std::move(shape));
  }
  return modes;
}

}  // namespace

SlepcEnvironment::SlepcEnvironment() {
  if (SlepcInitializeNoArguments() != 0) throw Error("SLEPc could not be initialised.");
}

SlepcEnvironment::~SlepcEnvironment() {
  if (std::uncaught_exceptions() == 0) SlepcFinalize();
}

EigenModes lowest_modes(const linalg::SparseMatrix& stiffness, const linalg::SparseMatrix& mass, int n,
                        double shift) {
  PetscInt rows = 0;
  linalg::petsc_check(MatGetSize(stiffness.petsc(), &rows, nullptr));
  if (n > rows)
    throw Error(
        "{} modes are requested, but the model has only {} unknowns. Request fewer modes or refine "
        "the model.",
        n, rows);
  Mat k = stiffness.petsc(), m = mass.petsc();
  linalg::petsc_check(MatSetOption(k, MAT_SYMMETRIC, PETSC_TRUE));
  linalg::petsc_check(MatSetOption(m, MAT_SYMMETRIC, PETSC_TRUE));
  // A group of equal eigenvalues may hide members from one Krylov space: more room, another try.
  for (int more = extra; more <= 8 * extra; more *= 2) {
    const int asked = static_cast<int>(std::min<PetscInt>(n + more, rows));
    Solver solver;
    linalg::petsc_check(EPSCreate(stiffness.comm(), &solver.eps));
    set_up(solver.eps, k, m, asked, shift);
    linalg::petsc_check(EPSSolve(solver.eps));
    EigenModes modes = converged(solver.eps, stiffness);
    const int found = static_cast<int>(modes.eigenvalue.size());
    if (found <= n) continue;
    const int end = widest_gap(modes.eigenvalue, n, shift);
    if (count_below(k, m, 0.5 * (modes.eigenvalue[end - 1] + modes.eigenvalue[end])) != end) continue;
    modes.next = modes.eigenvalue[n];
    modes.eigenvalue.resize(n);
    modes.shape.resize(n);
    return modes;
  }
  throw SolveFailure(
      "Cannot verify the {} lowest modes: the eigenvalue solver returned fewer, or not those that the pivot "
      "count predicts. Check that the model is connected and its stiffness is positive, or request fewer "
      "modes.",
      n);
}

bool cuts_a_group(const EigenModes& modes, double within) {
  return !modes.eigenvalue.empty() && modes.next - modes.eigenvalue.back() < within * std::abs(modes.next);
}

}  // namespace couplet::modes
