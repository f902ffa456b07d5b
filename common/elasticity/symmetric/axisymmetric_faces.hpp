// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Strain of a body of revolution at a face, x being the radius r and y the axis of revolution. Over the quadrilateral of
/// the two nodes P, Q beside the face and its vertices, with values that are linear along its sides, Gauss's theorem says
///   integral of r du/dz = sum of sides (int r u n_z),   integral of (r du/dr + u) = sum of sides (int r u n_r),
/// and with u_m, the value at the centroid r_m of the quadrilateral, of area A,
///   d u/dz = sum (int r u n_z) / (r_m A),   h = u_r / r = u_m / r_m,   du/dr + u_m / r_m = sum (int r u n_r) / (r_m A).
/// Exact for linear fields; a constant stress with equal radial and hoop parts leaves no force inside, on any cells. At a
/// plane of symmetry and at the axis the triangle of the cell with the vertices counts, where shear across is zero.
struct AxisymmetricFace {
  std::array<std::array<double, 2>, 4> b;  ///< of owner, node across, first, second point: d/dr, d/dz [1/m]
  std::array<double, 4> hoop;              ///< of the radial components [1/m]
  std::array<Index, 2> point;
  double volume;   ///< of the ring, 2 pi r_m A [m^3]
  bool has_shear;  ///< false: at a plane of symmetry; the node across does not count there
};

AxisymmetricFace axisymmetric_face(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f);

/// 2 pi r of a place: by it the numbers of a plane scene, which are those of a unit of depth, become those of the ring [m].
double circumference(double radius);

}  // namespace couplet::elastic
