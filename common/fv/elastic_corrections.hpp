// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/fv/elasticity.hpp"

namespace couplet {

/// Least-squares gradients of the owned cells: G_P = sum_i c_i (u_i - u_P) over the nodes across the cell's
/// faces, weight 1/d^3; a symmetry plane gives the mirrored cell, u_mirror - u_P = -2 n (n . u_P).
struct CellGradients {
  std::vector<Index> offset{0}, node;  ///< nodes as in VertexInterpolation
  std::vector<Vec3> weight;            ///< c_i [1/m]
  struct Mirror {
    Index cell;
    Vec3 weight, normal;
  };
  std::vector<Mirror> mirrors;

  CellGradients(const Mesh& mesh, const ElasticOperator& rows);
};

/// The edges of the faces that carry a force (3-D) by what is asked of them, an edge between both kinds of
/// faces being there twice: first those of quadrilaterals, whose middle value is wanted, then those of
/// triangles, whose mean is (for a quadratic field the mean gradient of a triangle is that at its centre),
/// then those with a vertex that is known or stands between materials, which get no correction.
struct FaceEdges {
  enum Kind { middle, mean, plain };
  std::vector<std::array<Index, 2>> points;
  std::array<Index, 2> end{};  ///< of `middle` and of `mean`
  std::vector<std::array<Index, 4>>
      of_face;  ///< edge i joins points i and i + 1; a triangle repeats its last

  FaceEdges(const Mesh& mesh, const ElasticOperator& rows);
};

/// Of these points those on symmetry planes, with the normals that differ.
struct MirrorVertex {
  Index point;
  std::vector<Vec3> normals;
};
std::vector<MirrorVertex> mirror_vertices(const Mesh& mesh, const ElasticOperator& rows,
                                          const std::vector<Index>& points);

}  // namespace couplet
