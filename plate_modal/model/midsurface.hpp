// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"

namespace couplet::plate {

using Vec2 = Eigen::Vector2d;

enum class Support { free, clamped, simply_supported, symmetry };

/// Complete mid-surface of a plate on one rank: a plane mesh of triangles and quadrilaterals.
struct Midsurface {
  std::vector<Vec2> points;  ///< [m]
  mesh::Csr cells;           ///< points of each cell, counter-clockwise
  std::vector<int> zone;     ///< per cell, index into `zones`
  std::vector<std::string> zones;
  struct Edge {
    Index from, to;  ///< counter-clockwise about the plate: the outside is to the right
    Index cell;
    int patch;       ///< index into `patches`
    int curve = -1;  ///< of the drawing, if known
  };
  std::vector<Edge> edges;  ///< the whole outline, each edge once
  std::vector<std::string> patches;
};

/// Orients cells counter-clockwise, removes unused points and finds the patch of every outline edge. Throws
/// Error with the place for an edge without a patch, with two, or inside the plate, for a cell without area,
/// or a point out of the plane. `curves`: curve of the drawing per boundary element; empty if unknown.
Midsurface midsurface_of(const mesh::RawMesh& raw, std::span<const int> curves = {});

/// Outline at each point of the mid-surface. Edges of a curve turn in proportion to the mesh size, those at a
/// corner by a fixed angle. `kink` is the rest of the turn after extrapolating the tangents of both sides to
/// the point from the midpoints of their last two edges (exact for lines and circles). A curve of the drawing
/// with one edge is straight. A turn of more than 55 degrees is a corner, because no mesh resolves it.
struct OutlinePoint {
  bool known = false;  ///< one edge ends and one starts here
  double turn = 0;     ///< between these two, positive to the left [rad]
  double kink = 0;     ///< of the curves themselves [rad]; 0 if there is no corner
  /// Unit tangents of the two sides at the point, equal without a corner.
  Vec2 before = Vec2::Zero(), after = Vec2::Zero();
};
std::vector<OutlinePoint> outline_of(const Midsurface& surface);

/// Convergence order in h, at most 2, of the deflection at a corner between two hinged edges that turns by
/// `kink` [rad]. The deflection is only as smooth as r^mu, mu the smallest of k pi/angle and 2 - k pi/angle
/// above 1 [blum1980], so the error decreases as h^(2 (mu - 1)).
double order_at_corner(double kink);

/// Relative mesh error of the deflection. `smooth`: error for a smooth or rectangular outline; `gap`, of order
/// h^2, gives that at corners, `kinks`, of lower order. Within a factor of 2 for a hexagon (5 and 10 edges per side), a
/// rhombus of 30 degrees and polygons of 12 sides. Corners below 20 degrees are weighted by their turn.
double with_corners(double smooth, double gap, std::span<const double> kinks);

/// Outline points between two simply supported edges that are corners of an order below 2. Straight lines
/// instead of a curved edge describe another plate there (Babuska's paradox). `support`: one per patch.
std::vector<Index> blunt_corners(const Midsurface& surface, const std::vector<OutlinePoint>& outline,
                                 const std::vector<Support>& support);

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
struct CornerTriangle {
  std::array<int, 3> corner;
  double share;
};
std::span<const CornerTriangle> pieces_of(std::size_t corners);

}  // namespace couplet::plate
