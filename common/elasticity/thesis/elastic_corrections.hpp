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
  std::vector<Index> offset{0}, node;          ///< nodes as in VertexInterpolation
  std::vector<float> weight;                   ///< w_i over the largest of the cell, as used in M
  std::vector<std::array<double, 6>> inverse;  ///< M^-1: xx, xy, xz, yy, yz, zz
  struct Mirror {
    Index cell;
    Vec3 weight, normal;  ///< M^-1 w d
  };
  std::vector<Mirror> mirrors;

  CellGradients(const mesh::Mesh& mesh, const ElasticOperator& rows);
};

/// Value used on an edge of a face (3-D): the middle on a quadrilateral, or the mean on a triangle (whose
/// mean gradient of a quadratic field is that at its center). No correction if a vertex is known or lies
/// between materials.
enum class EdgeKind : std::uint8_t { plain, middle, mean };
/// Kinds of the edges of faces with a force, two bits per edge. Edge i joins points i and i + 1.
std::vector<std::uint32_t> edge_kinds(const mesh::Mesh& mesh, const ElasticOperator& rows);

/// Selects points whose nodes are too far away to extrapolate gradients. Their weights would amplify gradient
/// errors, and the operator would lose its positive eigenvalues.
std::vector<Index> plain_points(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                const std::vector<Index>& points);

/// Point on symmetry planes with their distinct normals.
struct MirrorVertex {
  Index point;
  std::vector<Vec3> normals;
};
std::vector<MirrorVertex> mirror_vertices(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                          const std::vector<Index>& points);

}  // namespace couplet::elastic
