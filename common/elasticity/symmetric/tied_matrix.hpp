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

/// A symmetric operator with the rows of ElasticOperator, held with the vertices as unknowns of their own, which multipliers
/// tie to the means of their nodes: exact where SymmetricKernel is (edges' shares, volume strain of cells, springs), and
/// with factors that are cheap: on 2161 tetrahedra 2.7e6 entries where the rows of the nodes alone have 1.6e7.
class TiedMatrix {
 public:
  /// Periodic meshes have vertices on several ranks at once: not those.
  static bool suits(const mesh::Mesh& mesh);
  /// Mesh and rows by reference. Collective.
  TiedMatrix(const mesh::Mesh& mesh, const ElasticOperator& rows, const EnergyParts& parts);

  /// y = A x on the rows of ElasticOperator. Collective.
  void apply(std::span<const double> x, std::span<double> y);
  /// LDL^T; what follows needs it. Throws SolveFailure. Collective.
  void factorise();
  /// y = A^-1 x. Throws SolveFailure. Collective.
  void solve(std::span<const double> x, std::span<double> y);
  /// Eigenvalues of A below zero, by Sylvester's law of inertia.
  GlobalIndex negative() const { return factors_->negative_pivots() - n_ties_; }

 private:
  void number_all();
  void add_ties(Assembly& assembly) const;
  linalg::SparseMatrix assemble(const EnergyParts& parts);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  std::size_t n_nodes_;        // unknown, of this rank; in the order of ElasticOperator
  std::vector<Index> points_;  // owned ones that are not known, in the order of their numbers
  Numbering number_;           // rank by rank: nodes, points, a multiplier for each of these
  GlobalIndex first_multiplier_ = 0;
  double tie_ = 0;
  linalg::SparseMatrix matrix_;
  GlobalIndex n_ties_ = 0;
  std::unique_ptr<linalg::SymmetricFactors> factors_;
  std::vector<double> from_, to_;
};

}  // namespace couplet::elastic
