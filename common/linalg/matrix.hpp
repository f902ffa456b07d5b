// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <petscmat.h>

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "common/parallel/index_map.hpp"

namespace couplet::linalg {

/// Local dot product with several partial sums, so that additions do not wait for each other.
inline double dot_here(std::span<const double> a, std::span<const double> b) {
  std::array<double, 8> sum{};
  std::size_t i = 0;
  for (; i + 8 <= b.size(); i += 8)
    for (std::size_t k = 0; k < 8; ++k) sum[k] += a[i + k] * b[i + k];
  for (; i < b.size(); ++i) sum[0] += a[i] * b[i];
  return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

/// Sums of the values over all ranks. Collective.
template <std::size_t N>
std::array<double, N> over_ranks(MPI_Comm comm, std::array<double, N> local) {
  MPI_Allreduce(MPI_IN_PLACE, local.data(), N, MPI_DOUBLE, MPI_SUM, comm);
  return local;
}

/// Linear map y = F(x) on the rows of this rank. Collective.
using LinearMap = std::function<void(std::span<const double> x, std::span<double> y)>;

/// PETSc matrix from triplets with fixed positions. Values are refilled without searching
/// (MatSetPreallocationCOO). Row and column numbers are global unknowns: entry * components + component.
class SparseMatrix {
 public:
  /// `row` and `column` are per triplet; duplicates are added. Only owned rows are allowed. Collective.
  SparseMatrix(MPI_Comm comm, GlobalIndex n_owned_rows, std::vector<GlobalIndex> row,
               std::vector<GlobalIndex> column, int block_size = 1);
  ~SparseMatrix();
  SparseMatrix(SparseMatrix&& other) noexcept;
  SparseMatrix& operator=(SparseMatrix&&) = delete;

  /// Sets one value per triplet, in the order of the constructor. Collective.
  void fill(std::span<const double> values);
  /// Computes y = A x on the owned rows. Collective.
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
