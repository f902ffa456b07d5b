// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/mesh/periodic_points.hpp"

namespace couplet::elastic {

/// Vertices on joined periodic patches. All copies of a point share one value and all nodes: u_V = sum over
/// copies k, sum over nodes i of w_ki u_i The weights of VertexInterpolation [thesis (2.48)-(2.51)] use sums
/// over all copies, so periodic linear fields are exact. Forces are distributed by the transpose. Fields must
/// be equal on both sides (displacements relative to a periodic mesh). A node belongs to one copy, on the
/// rank that owns the copy.
class JoinedVertices {
 public:
  /// Throws Error if the copies of a point have different conditions. Collective.
  JoinedVertices(const mesh::Mesh& mesh, const ElasticOperator& rows);

  /// All local copies, including points with known values.
  const std::vector<Index>& all() const { return periodic_.points(); }
  bool has(Index point) const { return joined_[point] != 0; }

  /// Interpolates to all copies, with ElasticNodes::stride doubles per entry. Collective.
  void interpolate(const double* nodes, std::span<double> points) const;
  /// Adds the forces on the points, of which each rank has a contribution, to those on the nodes. Collective.
  void to_nodes(std::span<double> point_forces, double* node_forces) const;

 private:
  void refuse_unlike() const;
  /// Weights of one kind and their magnification n sum w^2, per entry of points_.
  struct JoinedWeights {
    std::vector<double> weight, magnification;
    std::vector<std::uint8_t> is_wide;
  };
  JoinedWeights weights(fv::VertexWeights kind) const;
  Vec3 from_node(Index point, Index node) const;
  const Tensor3* within(Index point) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  mesh::PeriodicPoints periodic_;
  std::vector<std::uint8_t> joined_;  // per local point
  std::vector<Index> points_;         // owned points that depend on nodes
  std::vector<std::int64_t> offset_{0};
  std::vector<double> weight_;  // of the nodes of each
};

}  // namespace couplet::elastic
