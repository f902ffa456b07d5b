// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/block_pairs.hpp"
#include "common/elasticity/prestress/pressure_stiffness.hpp"
#include "common/elasticity/tied/tied_terms.hpp"

namespace couplet::elastic {

/// dP/dF or C, entry (3 k + a, 3 m + c): what the derivative c of component m does to the stress (k, a) [Pa].
using GradientStiffness = Eigen::Matrix<double, 9, 9>;

GradientStiffness stiffness_of(const LameConstants& lame);
GradientStiffness stiffness_of(const ElasticMatrix& matrix);
/// I (x) sigma: the work of a stress that is there on the square of the displacement gradient.
GradientStiffness stiffness_of_stress(const Tensor3& stress);

/// Blocks between nodes and vertices, added up pair by pair, with the ties u_V = F_V sum_i w_i u_i of the vertices as rows of
/// multipliers.
class TiedAssembly {
 public:
  /// All by reference.
  TiedAssembly(const mesh::Mesh& mesh, const ElasticOperator& rows, const TiedUnknowns& unknowns);

  /// sum_ij T_i^T [b_i . stiffness . b_j] T_j of gradients, `stiffness` times the volume [N m].
  void add(std::span<const TiedTerm> terms, const GradientStiffness& stiffness);
  /// V_P theta_P of an owned cell changes by g . u.
  void add_volume_term(Index cell, GlobalIndex block, const Vec3& g) {
    volume_of_[cell].push_back({block, g});
  }
  /// modulus(cell) g g^T of what was added.
  template <class Modulus>
  void finish_volumes(const Modulus& modulus) {
    for (auto& [cell, terms] : volume_of_) pairs_.add_squares(terms, modulus(cell));
    volume_of_.clear();
  }
  /// The rows of supports and their springs.
  void add_supports();
  /// A lumped mass times `factor`, one value a local node and a local vertex, this rank's part [kg].
  void add_mass(double factor, std::span<const double> of_nodes, std::span<const double> of_points);
  /// Blocks between places times `factor`.
  void add_places(double factor, std::span<const PlaceBlock> blocks);
  /// With the ties times `tie`; 0: the mean of the diagonal. Collective.
  linalg::SparseMatrix matrix(double& tie);

 private:
  void add_block(GlobalIndex i, GlobalIndex j, const Tensor3& block) { pairs_.add(i, j, block); }
  void add_ties(double tie);
  double mean_diagonal() const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  const TiedUnknowns& unknowns_;
  BlockPairs<GlobalIndex> pairs_;
  std::map<Index, std::vector<std::pair<GlobalIndex, Vec3>>> volume_of_;
};

}  // namespace couplet::elastic
