// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/block_pairs.hpp"
#include "common/elasticity/symmetric/face_stencil.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// Blocks between the nodes of a body, added up pair by pair and made a matrix with the rows of ElasticOperator.
class NodeAssembly {
 public:
  /// Both by reference.
  NodeAssembly(const mesh::Mesh& mesh, const ElasticOperator& rows);

  FaceStencil& stencil() { return stencil_; }
  void add_block(Index i, Index j, const Tensor3& block) { pairs_.add(i, j, block); }
  /// V_P theta_P of a cell changes by g . u of this node. Of owned cells, from all their faces: those of other ranks, too.
  void add_volume_term(Index cell, Index node, const Vec3& g) {
    if (cell < mesh_.cells.n_owned()) volume_of_[cell].push_back({node, g});
  }
  /// modulus(cell) g g^T of what was added, K / V for a linear body.
  void finish_volumes(const std::function<double(Index)>& modulus);
  /// s P on the rows of supports; springs at the face's node alone, which a preconditioner may.
  void add_supports();
  /// On the diagonals, one value an unknown node; empty: none.
  void add_diagonals(std::span<const double> of_nodes);
  /// A mass that is lumped at nodes and points times `factor` [1/s^2]: between the nodes that a point is interpolated from.
  template <int D>
  void add_mass(double factor, const SymmetricSpace<D>& space);
  /// Collective.
  linalg::SparseMatrix matrix() const;

 private:
  Index node_of(Index f) const { return mesh_.cells.n_local() + f - mesh_.n_interior; }
  void add_diagonal(Index node, double value) { add_block(node, node, value * Tensor3::Identity()); }

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  std::vector<GlobalIndex> number_;
  FaceStencil stencil_;
  BlockPairs<Index> pairs_;
  std::map<Index, std::vector<std::pair<Index, Vec3>>> volume_of_;  // of cells, by nodes
};

}  // namespace couplet::elastic
