// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/matrix.hpp"

#include <cassert>
#include <exception>
#include <utility>

#include "common/linalg/petsc.hpp"

namespace couplet::linalg {

SparseMatrix::SparseMatrix(MPI_Comm comm, GlobalIndex n_owned_rows, std::vector<GlobalIndex> row,
                           std::vector<GlobalIndex> column, int block_size)
    : comm_(comm), n_owned_(n_owned_rows) {
  assert(row.size() == column.size());
  petsc_check(MatCreate(comm, &matrix_));
  const auto n = static_cast<PetscInt>(n_owned_rows);
  petsc_check(MatSetSizes(matrix_, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  petsc_check(MatSetType(matrix_, MATAIJ));
  petsc_check(MatSetBlockSize(matrix_, block_size));
  std::vector<PetscInt> i(row.begin(), row.end());
  std::vector<GlobalIndex>().swap(row);  // frees memory before the peak below
  std::vector<PetscInt> j(column.begin(), column.end());
  std::vector<GlobalIndex>().swap(column);
  petsc_check(MatSetPreallocationCOO(matrix_, static_cast<PetscCount>(i.size()), i.data(), j.data()));
  petsc_check(MatCreateVecs(matrix_, &x_, &y_));
}

SparseMatrix::~SparseMatrix() {
  // Destroying PETSc objects is collective. During unwinding they are left to the end of the process.
  if (!matrix_ || std::uncaught_exceptions() > 0) return;
  MatDestroy(&matrix_);
  VecDestroy(&x_);
  VecDestroy(&y_);
}

SparseMatrix::SparseMatrix(SparseMatrix&& other) noexcept
    : comm_(other.comm_),
      n_owned_(other.n_owned_),
      matrix_(std::exchange(other.matrix_, nullptr)),
      x_(std::exchange(other.x_, nullptr)),
      y_(std::exchange(other.y_, nullptr)) {}

void SparseMatrix::fill(std::span<const double> values) {
  petsc_check(MatSetValuesCOO(matrix_, values.data(), INSERT_VALUES));
}

void SparseMatrix::multiply(std::span<const double> x, std::span<double> y) const {
  petsc_check(VecPlaceArray(x_, x.data()));
  petsc_check(VecPlaceArray(y_, y.data()));
  petsc_check(MatMult(matrix_, x_, y_));
  petsc_check(VecResetArray(x_));
  petsc_check(VecResetArray(y_));
}

}  // namespace couplet::linalg
