// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "plate_modal/model/midsurface.hpp"

namespace couplet::plate {

/// The discrete Kirchhoff triangle [batoz1980]. Unknowns of vertex i: 3 i the deflection w [m], 3 i + 1 and
/// 3 i + 2 its slopes w,x and w,y. The slopes of the triangle are quadratic, joined to w along the edges,
/// where it is cubic; constant curvature is exact on any triangle, frequencies and deflections are second
/// order.
using TriangleMatrix = Eigen::Matrix<double, 9, 9>;
using TriangleVector = Eigen::Matrix<double, 9, 1>;
using Triangle = std::array<Vec2, 3>;

/// Integral of the bending energy for `rigidity` D = E h^3 / (12 (1 - nu^2)) [N m].
TriangleMatrix bending_stiffness(const Triangle& x, double rigidity, double poissons_ratio);

/// Integral of rho h w w for the cubic w that has the triangle's vertex values and slopes and is exact for
/// quadratic w ([zienkiewicz1965], rotary inertia left out as in Kirchhoff's theory); `density` rho h
/// [kg/m^2].
TriangleMatrix inertia(const Triangle& x, double density);

/// Mean of that w over the triangle, as the weights of the nine unknowns.
TriangleVector mean_deflection(const Triangle& x);

double area(const Triangle& x);

/// The triangles of a cell and the share of each: a triangle itself; a quadrilateral is the mean of its two
/// ways of being cut, which keeps symmetric meshes symmetric.
struct Piece {
  std::array<int, 3> corner;
  double share;
};
std::span<const Piece> pieces_of(std::size_t corners);

}  // namespace couplet::plate
