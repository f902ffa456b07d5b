// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscmat.h>

#include <span>

#include "common/linalg/matrix.hpp"
#include "common/parallel/gathered_rows.hpp"

namespace couplet::linalg {

/// L D L^T factors of a symmetric, possibly indefinite matrix (MUMPS, pivots of one or two rows). Up to 60
/// 000 rows are factorized on every rank, for lower latency and reproducible bits.
class SymmetricFactors {
 public:
  /// Factorizes the matrix. Throws SolveFailure. Collective.
  explicit SymmetricFactors(const SparseMatrix& matrix) : SymmetricFactors(matrix.petsc()) {}
  /// Factorizes a - s b.
  SymmetricFactors(const SparseMatrix& a, const SparseMatrix& b, double s);
  ~SymmetricFactors();
  SymmetricFactors(const SymmetricFactors&) = delete;
  SymmetricFactors& operator=(const SymmetricFactors&) = delete;

  /// Computes x = A^-1 b on the owned rows. Throws SolveFailure if it is not finite. Collective.
  void solve(std::span<const double> b, std::span<double> x) const;
  /// Number of negative eigenvalues, by Sylvester's law of inertia.
  GlobalIndex negative_pivots() const { return negative_; }

 private:
  explicit SymmetricFactors(Mat matrix);
  void factorise(Mat matrix);

  Mat factors_ = nullptr;
  ::Vec b_ = nullptr, x_ = nullptr;              // of the owned rows
  ::Vec whole_b_ = nullptr, whole_x_ = nullptr;  // of all rows, for a matrix replicated on every rank
  parallel::GatheredRows gathered_;
  GlobalIndex negative_ = 0;
};

}  // namespace couplet::linalg
