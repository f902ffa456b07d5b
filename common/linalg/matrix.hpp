// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscmat.h>

#include <span>
#include <vector>

#include "common/parallel/index_map.hpp"

namespace couplet::linalg {

/// Rows of a PETSc matrix from triplets whose places are fixed once; values are refilled without any search
/// (MatSetPreallocationCOO). Row and column numbers are global unknowns: entry * components + component.
class SparseMatrix {
 public:
  /// `row`, `column`: one per triplet; repeated places add up. Only owned rows may appear. Collective.
  SparseMatrix(MPI_Comm comm, GlobalIndex n_owned_rows, std::vector<GlobalIndex> row,
               std::vector<GlobalIndex> column, int block_size = 1);
  ~SparseMatrix();
  SparseMatrix(SparseMatrix&& other) noexcept;
  SparseMatrix& operator=(SparseMatrix&&) = delete;

  /// One value per triplet, in the order of the constructor. Collective.
  void fill(std::span<const double> values);
  /// y = A x on the owned rows. Collective.
  void multiply(std::span<const double> x, std::span<double> y) const;
  Mat petsc() const { return matrix_; }
  MPI_Comm comm() const { return comm_; }
  GlobalIndex n_owned_rows() const { return n_owned_; }

 private:
  MPI_Comm comm_;
  GlobalIndex n_owned_;
  Mat matrix_ = nullptr;
  ::Vec x_ = nullptr, y_ = nullptr;
};

}  // namespace couplet::linalg
