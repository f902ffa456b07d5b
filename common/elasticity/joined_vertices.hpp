// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/mesh/periodic_points.hpp"

namespace couplet::elastic {

/// Vertices on joined periodic patches: their copies are one point with the nodes around all of them,
///   u_V = sum over copies k, sum over nodes i of w_ki u_i,
/// by the weights of VertexInterpolation [thesis (2.48)-(2.51)] from the sums over all copies, so that a linear field that is
/// periodic is met and no place is a border. Forces go back by the transpose. For fields that are the same on both sides
/// (displacements relative to a periodic mesh). A node belongs to one copy on one rank, that which owns the copy.
class JoinedVertices {
 public:
  /// Throws Error where the conditions at the copies of a point are not alike. Collective.
  JoinedVertices(const mesh::Mesh& mesh, const ElasticOperator& rows);

  /// All local copies, of points that are known, too.
  const std::vector<Index>& all() const { return periodic_.points(); }
  bool has(Index point) const { return joined_[point] != 0; }

  /// Values of all copies. `nodes`, `points`: ElasticNodes::stride doubles a node, a local point. Collective.
  void interpolate(const double* nodes, std::span<double> points) const;
  /// Adds the forces on the points, of which each rank has its own part, to those on the nodes. Collective.
  void to_nodes(std::span<double> point_forces, double* node_forces) const;

 private:
  void refuse_unlike() const;
  /// Weights of one kind, with their magnification n sum w^2, per entry of points_.
  struct Weights {
    std::vector<double> weight, magnification;
    std::vector<std::uint8_t> is_wide;
  };
  Weights weights(fv::VertexWeights kind) const;
  Vec3 from_node(Index point, Index node) const;
  const Tensor3* within(Index point) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  mesh::PeriodicPoints periodic_;
  std::vector<std::uint8_t> joined_;  // per local point
  std::vector<Index> points_;         // owned ones whose nodes matter
  std::vector<std::int64_t> offset_{0};
  std::vector<double> weight_;  // of the nodes of each
};

}  // namespace couplet::elastic
