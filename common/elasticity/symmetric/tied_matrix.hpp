// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/linalg/matrix.hpp"
#include "common/linalg/symmetric_factors.hpp"

namespace couplet::elastic {

/// Symmetric operator with the rows of ElasticOperator, stored with the vertices as additional unknowns that
/// Lagrange multipliers tie to the means of their nodes. It is as exact as SymmetricKernel, and cheap to
/// factorize: for 2161 tetrahedra it has 2.7e6 entries instead of 1.6e7.
class TiedMatrix {
 public:
  /// Returns false for periodic meshes, whose vertices exist on several ranks at once.
  static bool suits(const mesh::Mesh& mesh);
  /// Keeps references to mesh and rows. Collective.
  TiedMatrix(const mesh::Mesh& mesh, const ElasticOperator& rows, const EnergyParts& parts);

  /// Computes y = A x on the rows of ElasticOperator. Collective.
  void apply(std::span<const double> x, std::span<double> y);
  /// Computes the LDL^T factorization that the following functions need. Throws SolveFailure. Collective.
  void factorise();
  /// Computes y = A^-1 x. Throws SolveFailure. Collective.
  void solve(std::span<const double> x, std::span<double> y);
  /// Number of negative eigenvalues of A, by Sylvester's law of inertia.
  GlobalIndex negative() const { return factors_->negative_pivots() - n_ties_; }

 private:
  void number_all();
  void add_ties(Assembly& assembly) const;
  linalg::SparseMatrix assemble(const EnergyParts& parts);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  std::size_t n_nodes_;        // unknown, of this rank; in the order of ElasticOperator
  std::vector<Index> points_;  // owned unknown ones, in the order of their numbers
  Numbering number_;           // rank by rank: nodes, points, a multiplier per point
  GlobalIndex first_multiplier_ = 0;
  double tie_ = 0;
  linalg::SparseMatrix matrix_;
  GlobalIndex n_ties_ = 0;
  std::unique_ptr<linalg::SymmetricFactors> factors_;
  std::vector<double> from_, to_;
};

}  // namespace couplet::elastic
