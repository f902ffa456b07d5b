// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/elasticity/elasticity.hpp"

namespace couplet::elastic {

/// Least-squares gradients of the owned cells over the nodes across the cell's faces,
///   G_P = M^-1 sum_i w_i d_i (u_i - u_P),   M = sum_i w_i d_i d_i^T,   w_i = 1 / |d_i|^3;
/// a symmetry plane gives the mirrored cell, u_mirror - u_P = -2 n (n . u_P).
struct CellGradients {
  std::vector<Index> offset{0}, node;  ///< nodes as in VertexInterpolation
  std::vector<float> weight;           ///< w_i over the largest of the cell; M holds these very numbers
  std::vector<std::array<double, 6>> inverse;  ///< M^-1: xx, xy, xz, yy, yz, zz
  struct Mirror {
    Index cell;
    Vec3 weight, normal;  ///< M^-1 w d
  };
  std::vector<Mirror> mirrors;

  CellGradients(const mesh::Mesh& mesh, const ElasticOperator& rows);
};

/// What is asked of an edge of a face (3-D): its middle value on a quadrilateral; its mean on a triangle (for
/// a quadratic field the mean gradient of a triangle is that at its centre); no correction where a vertex is
/// known or stands between materials.
enum class EdgeKind : std::uint8_t { plain, middle, mean };
/// Of the faces that carry a force, two bits an edge; edge i joins points i and i + 1.
std::vector<std::uint32_t> edge_kinds(const mesh::Mesh& mesh, const ElasticOperator& rows);

/// Of these points those that the nodes around reach from too far for gradients to be carried over: the
/// weights that extrapolate magnify what the gradients err by, and the operator loses its positive
/// eigenvalues.
std::vector<Index> plain_points(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                const std::vector<Index>& points);

/// Of these points those on symmetry planes, with the normals that differ.
struct MirrorVertex {
  Index point;
  std::vector<Vec3> normals;
};
std::vector<MirrorVertex> mirror_vertices(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                          const std::vector<Index>& points);

}  // namespace couplet::elastic
