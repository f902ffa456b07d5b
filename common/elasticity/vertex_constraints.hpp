// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/elasticity/elastic_boundary.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// What is known of the displacement at the vertices, from the conditions of the faces around them:
///   u_V = F_V sum_i w_i u_i + g_V,   F_V = I - Q_V,   g_V = sum_j G_j g_j(x_V)
/// Q_V is the projector on the known directions; g_j is the known vector of the condition of boundary face j,
/// taken at the vertex, so that g_V = Q_V g_V. Rules, in this order:
/// - A vertex of a fixed face is known in all directions, from the first fixed face around it (order
///   of the patches, then of the faces).
/// - Supports: of each patch, in the order of the patches, those directions in which the patch's faces around
///   the vertex agree: eigenvalue of their mean P above 3/4, so that a curved patch keeps its mean normal,
///   and a support of a part of a patch ends at the last face of the part. What an earlier patch knows
///   already stays; a later one adds what is still free, oblique directions included.
/// - Symmetry planes: no displacement across them.
class VertexConstraints {
 public:
  struct Source {
    Index face;     ///< entry of mesh.boundary
    Tensor3 share;  ///< G_j
  };

  VertexConstraints(const mesh::Mesh& mesh, const ElasticBoundary& boundary,
                    const fv::VertexInterpolation& vertices);

  /// F_V: I where nothing is known, 0 where all is.
  const Tensor3& free_part(Index point) const { return free_parts_[free_of_[point]]; }
  bool is_constrained(Index point) const { return free_of_[point] != 0; }
  bool is_fixed(Index point) const { return free_of_[point] == 1; }
  /// Points with a known value g_V (those on symmetry planes only have none), ascending; entry i is column i.
  const std::vector<Index>& points() const { return points_; }
  Index column(Index point) const { return column_[point]; }  ///< -1: no value
  std::span<const Source> sources(Index column) const {
    return {sources_.data() + offset_[column], std::size_t(offset_[column + 1] - offset_[column])};
  }

 private:
  class Known;
  void constrain(Index point, std::span<const Index> faces, const mesh::Mesh& mesh,
                 const ElasticBoundary& boundary, std::span<const Index> patch_of_face,
                 const Tensor3& symmetry);
  void store(Index point, const Known& known);

  std::vector<Index> free_of_;  // per point, into free_parts_
  std::vector<Tensor3> free_parts_{Tensor3::Identity(), Tensor3::Zero()};
  std::vector<Index> points_, column_;
  std::vector<Index> offset_{0};
  std::vector<Source> sources_;
};

}  // namespace couplet::elastic
