// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscmat.h>

#include <span>

#include "common/linalg/matrix.hpp"

namespace couplet::linalg {

/// L D L^T of a symmetric matrix that need not be positive (MUMPS, pivots of one or two rows). Those of up to 60 000 rows
/// are factorised whole on every rank: less latency, and the same bits in every run.
class SymmetricFactors {
 public:
  /// Throws SolveFailure. Collective.
  explicit SymmetricFactors(const SparseMatrix& matrix) : SymmetricFactors(matrix.petsc()) {}
  /// Factors of a - s b.
  SymmetricFactors(const SparseMatrix& a, const SparseMatrix& b, double s);
  ~SymmetricFactors();
  SymmetricFactors(const SymmetricFactors&) = delete;
  SymmetricFactors& operator=(const SymmetricFactors&) = delete;

  /// x = A^-1 b on the owned rows. Throws SolveFailure if it is not finite. Collective.
  void solve(std::span<const double> b, std::span<double> x) const;
  /// Eigenvalues of the matrix below zero, by Sylvester's law of inertia.
  GlobalIndex negative_pivots() const { return negative_; }

 private:
  explicit SymmetricFactors(Mat matrix);
  void factorise(Mat matrix);

  Mat factors_ = nullptr;
  ::Vec b_ = nullptr, x_ = nullptr;  // of the owned rows
  VecScatter to_all_ = nullptr;      // of a matrix that is whole on every rank
  ::Vec whole_b_ = nullptr, whole_x_ = nullptr;
  PetscInt first_ = 0;  // of the owned rows
  GlobalIndex negative_ = 0;
};

}  // namespace couplet::linalg
