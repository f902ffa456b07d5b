// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// The face gradient of the symmetric operator, from the two nodes beside a face and its vertices, exact for
/// linear fields on any face (Green-Gauss over the double pyramid of the two nodes and the face; equal to
/// FaceGradient on flat faces):
///   G = [(u_Q - u_P) S^T + sum_i (u_plus_i - u_minus_i) c_i^T] / (S . d),   entry (k, j) = d u_k / d x_j
/// with d = x_Q - x_P, and d_i the one difference of vertices (2-D) or the two (3-D: the diagonals of a
/// quadrilateral, two sides of a triangle): S = d_0 x d_1 / 2, c_0 = d_1 x d / 2, c_1 = d x d_0 / 2 are the
/// cofactors of [d_0, d_1, d]. In the plane c is d turned by a right angle. The volume between the nodes is V
/// = S . d / dim. At a symmetry plane Q is the mirror image of P, and half of the pyramids' energy is the
/// body's.
template <int D>
struct SymmetricFace {
  std::array<double, D> area;                       ///< S [m^2], out of the owner
  std::array<std::array<double, D>, D - 1> across;  ///< c_i [m^2]
  double inverse;                                   ///< 1 / (S . d) [1/m^3]
  double volume;                                    ///< of which the energy counts, V or V / 2 [m^3]
  std::array<Index, D - 1> plus, minus;             ///< points
};

template <int D>
SymmetricFace<D> symmetric_face(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f);

/// Shares with which the points around a face, in their order, take what acts on it evenly: they add up to 1
/// and their mean place is the face centre. By the triangles between the centre and the edges.
std::array<double, 4> point_shares(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f);

/// V_fP of the two sides [m^3]: pyramids from the cell's centre over the face; the second is 0 on the
/// boundary.
std::array<double, 2> pyramids(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f);

}  // namespace couplet::elastic
