// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "plate_modal/model/midsurface.hpp"

namespace couplet::plate {

/// Discrete Kirchhoff triangle [batoz1980]. Unknowns of vertex i: 3 i the deflection w [m], 3 i + 1 and 3 i +
/// 2 the slopes w,x and w,y. The slopes are quadratic, and tied along the edges to a cubic w. Constant
/// curvature is exact on any triangle; frequencies and deflections are second order.
using TriangleMatrix = Eigen::Matrix<double, 9, 9>;
using TriangleVector = Eigen::Matrix<double, 9, 1>;
using Triangle = std::array<Vec2, 3>;

/// Integral of the bending energy for `rigidity` D = E h^3 / (12 (1 - nu^2)) [N m].
TriangleMatrix bending_stiffness(const Triangle& x, double rigidity, double poissons_ratio);

/// Integral of rho h w w for the cubic w with the triangle's vertex values and slopes, exact for quadratic w
/// ([zienkiewicz1965], without rotary inertia as in Kirchhoff's theory). `density`: rho h [kg/m^2].
TriangleMatrix inertia(const Triangle& x, double density);

/// Mean of w over the triangle, as weights of the nine unknowns.
TriangleVector mean_deflection(const Triangle& x);

double area(const Triangle& x);

/// Triangles of a cell and their weights. A quadrilateral is the mean of both ways of splitting it, which
/// preserves symmetry.
struct Piece {
  std::array<int, 3> corner;
  double share;
};
std::span<const Piece> pieces_of(std::size_t corners);

}  // namespace couplet::plate
