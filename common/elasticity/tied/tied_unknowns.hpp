// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Numbers of blocks of dim rows, rank by rank: the unknown nodes in the order of ElasticOperator, then the owned
/// vertices whose value is not known, then a multiplier for each of these.
class TiedUnknowns {
 public:
  /// Collective.
  TiedUnknowns(const mesh::Mesh& mesh, const ElasticOperator& rows);

  /// Of a local node (cells, then boundary faces); -1: known.
  GlobalIndex node(Index local) const { return node_[std::size_t(local)]; }
  /// Of a local vertex; -1: known.
  GlobalIndex point(Index local) const { return point_[std::size_t(local)]; }
  /// Owned vertices, in the order of their numbers, and the number of the multiplier of the first.
  const std::vector<Index>& points() const { return points_; }
  GlobalIndex first_multiplier() const { return first_multiplier_; }
  std::size_t n_nodes() const { return n_nodes_; }
  std::size_t n_blocks() const { return n_nodes_ + 2 * points_.size(); }

 private:
  std::vector<GlobalIndex> node_, point_;
  std::vector<Index> points_;
  GlobalIndex first_multiplier_ = 0;
  std::size_t n_nodes_ = 0;
};

}  // namespace couplet::elastic
