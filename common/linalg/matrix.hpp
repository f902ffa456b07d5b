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
  /// For values that are given once, by set() and complete(): no tables for a refill. `own`, `other`: entries
  /// of each owned row in owned columns and in those of other ranks. Collective.
  SparseMatrix(MPI_Comm comm, const std::vector<int>& own, const std::vector<int>& other);
  ~SparseMatrix();
  SparseMatrix(SparseMatrix&& other) noexcept;
  SparseMatrix& operator=(SparseMatrix&&) = delete;

  /// One value per triplet, in the order of the constructor. Collective.
  void fill(std::span<const double> values);
  void set(GlobalIndex row, GlobalIndex column, double value);
  /// After all set(). Collective.
  void complete();
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
