// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/symmetric_factors.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "common/linalg/petsc.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

constexpr PetscInt largest_whole = 60000;

/// Matrix a - s b, destroyed with the object.
class Shifted {
 public:
  Shifted(Mat a, Mat b, double s) {
    petsc_check(MatDuplicate(a, MAT_COPY_VALUES, &matrix));
    petsc_check(MatAXPY(matrix, -s, b, UNKNOWN_NONZERO_PATTERN));
  }
  ~Shifted() {
    if (std::uncaught_exceptions() == 0) MatDestroy(&matrix);
  }
  Mat matrix = nullptr;
};

}  // namespace

SymmetricFactors::SymmetricFactors(const SparseMatrix& a, const SparseMatrix& b, double s)
    : SymmetricFactors(Shifted(a.petsc(), b.petsc(), s).matrix) {}

SymmetricFactors::SymmetricFactors(Mat a) {
  const int ranks = parallel::comm_size(PetscObjectComm(reinterpret_cast<PetscObject>(a)));
  petsc_check(MatSetOption(a, MAT_SYMMETRIC, PETSC_TRUE));
  petsc_check(MatCreateVecs(a, &x_, &b_));
  PetscInt rows = 0;
  petsc_check(MatGetSize(a, &rows, nullptr));
  if (ranks == 1 || rows > largest_whole) {
    factorise(a);
    return;
  }
  PetscInt here = 0;
  petsc_check(MatGetLocalSize(a, &here, nullptr));
  gathered_ = parallel::GatheredRows(PetscObjectComm(reinterpret_cast<PetscObject>(a)), here, sizeof(double));
  Mat whole = nullptr;
  petsc_check(MatCreateRedundantMatrix(a, ranks, MPI_COMM_NULL, MAT_INITIAL_MATRIX, &whole));
  petsc_check(MatSetOption(whole, MAT_SYMMETRIC, PETSC_TRUE));
  petsc_check(MatCreateVecs(whole, &whole_x_, &whole_b_));
  factorise(whole);
  petsc_check(MatDestroy(&whole));
}

void SymmetricFactors::factorise(Mat a) {
  petsc_check(MatGetFactor(a, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &factors_));
  petsc_check(MatMumpsSetIcntl(factors_, 24, 1));  // required to count negative pivots
  // Additional memory [%], since pivots of two rows need more than predicted.
  petsc_check(MatMumpsSetIcntl(factors_, 14, 100));
  MatFactorInfo info;
  petsc_check(MatFactorInfoInitialize(&info));
  petsc_check(MatCholeskyFactorSymbolic(factors_, a, nullptr, &info));
  petsc_check(MatCholeskyFactorNumeric(factors_, a, &info));
  MatFactorError error = MAT_FACTOR_NOERROR;
  petsc_check(MatFactorGetError(factors_, &error));
  if (error != MAT_FACTOR_NOERROR)
    throw SolveFailure(
        "MUMPS could not factorize a symmetric matrix (PETSc's MatFactorError {}): is there enough memory?",
        int(error));
  PetscInt negative = 0, zero = 0, positive = 0;
  petsc_check(MatGetInertia(factors_, &negative, &zero, &positive));
  negative_ = negative;
}

SymmetricFactors::~SymmetricFactors() {
  if (std::uncaught_exceptions() > 0) return;
  MatDestroy(&factors_);
  for (::Vec* v : {&b_, &x_, &whole_b_, &whole_x_}) VecDestroy(v);
}

void SymmetricFactors::solve(std::span<const double> b, std::span<double> x) const {
  petsc_check(VecPlaceArray(b_, b.data()));
  petsc_check(VecPlaceArray(x_, x.data()));
  if (whole_b_) {
    double* right = nullptr;
    petsc_check(VecGetArray(whole_b_, &right));
    gathered_.gather(b.data(), right);
    petsc_check(VecRestoreArray(whole_b_, &right));
    petsc_check(MatSolve(factors_, whole_b_, whole_x_));
    const double* all = nullptr;
    petsc_check(VecGetArrayRead(whole_x_, &all));
    std::copy_n(all + gathered_.first(), x.size(), x.begin());
    petsc_check(VecRestoreArrayRead(whole_x_, &all));
  } else {
    petsc_check(MatSolve(factors_, b_, x_));
  }
  petsc_check(VecResetArray(b_));
  petsc_check(VecResetArray(x_));
  double square = 0;
  for (const double v : x) square += v * v;
  if (!std::isfinite(parallel::sum(PetscObjectComm(reinterpret_cast<PetscObject>(b_)), square)))
    throw SolveFailure("The solution of a symmetric system with its factors is not finite.");
}

}  // namespace couplet::linalg
