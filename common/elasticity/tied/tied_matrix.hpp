// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/prestress/stress_stiffness.hpp"
#include "common/elasticity/tied/tied_unknowns.hpp"
#include "common/linalg/matrix.hpp"
#include "common/linalg/symmetric_factors.hpp"

namespace couplet::elastic {

/// stiffness K + mass M + stress K_sigma of the symmetric gradient.
struct TiedParts {
  double stiffness = 1;
  double mass = 0;                       ///< [1/s^2]
  std::span<const double> density{};     ///< of the owned cells [kg/m^3]; for `mass`
  double stress = 0;                     ///< of K_sigma, see StressStiffness
  const Prestress* prestress = nullptr;  ///< for `stress`
};

/// A symmetric operator with the rows of ElasticOperator, held with the vertices as unknowns of their own: exact where
/// SymmetricKernel is (edges' shares, volume strain of cells, springs), and with factors that are cheap: on 2161
/// tetrahedra 2.7e6 entries where the rows of the nodes alone have 1.6e7.
class TiedMatrix {
 public:
  /// Periodic meshes have vertices on several ranks at once: not those.
  static bool suits(const mesh::Mesh& mesh);
  /// Mesh and rows by reference. Collective.
  TiedMatrix(const mesh::Mesh& mesh, const ElasticOperator& rows, const TiedParts& parts);

  /// y = A x on the rows of ElasticOperator. Collective.
  void apply(std::span<const double> x, std::span<double> y);
  /// LDL^T; what follows needs it. Throws SolveFailure. Collective.
  void factorise();
  /// y = A^-1 x. Throws SolveFailure. Collective.
  void solve(std::span<const double> x, std::span<double> y);
  /// Eigenvalues of A below zero, by Sylvester's law of inertia.
  GlobalIndex negative() const { return factors_->negative_pivots() - n_ties_; }
  /// Rows of all ranks with the vertices and ties.
  GlobalIndex n_rows() const { return n_rows_; }

 private:
  linalg::SparseMatrix assemble(const TiedParts& parts);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  TiedUnknowns unknowns_;
  double tie_ = 0;
  linalg::SparseMatrix matrix_;
  GlobalIndex n_ties_ = 0, n_rows_ = 0;
  std::unique_ptr<linalg::SymmetricFactors> factors_;
  std::vector<double> from_, to_;
};

}  // namespace couplet::elastic
