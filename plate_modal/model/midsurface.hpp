// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"

namespace couplet::plate {

using Vec2 = Eigen::Vector2d;

enum class Support { free, clamped, simply_supported, symmetry };

/// The mid-surface of a plate, whole, on one rank: a plane mesh of triangles and quadrilaterals.
struct Midsurface {
  std::vector<Vec2> points;  ///< [m]
  mesh::Csr cells;           ///< points of each cell, counter-clockwise
  std::vector<int> zone;     ///< per cell, index into `zones`
  std::vector<std::string> zones;
  struct Edge {
    Index from, to;  ///< counter-clockwise about the plate: the outside lies to the right
    Index cell;
    int patch;       ///< index into `patches`
    int curve = -1;  ///< of the drawing, if that is known
  };
  std::vector<Edge> edges;  ///< the whole outline, each once
  std::vector<std::string> patches;
};

/// Turns cells counter-clockwise, drops points that no cell uses and finds the patch of every edge of the
/// outline. Throws Error naming the place of an edge without a patch, of two patches or of one inside the plate, of a
/// cell without area, or of a point out of the plane. `curves`: of each boundary element the curve of the drawing; empty:
/// not known.
Midsurface midsurface_of(const mesh::RawMesh& raw, std::span<const int> curves = {});

/// The outline at each point of the mid-surface. Within a curve edges turn by as much as the mesh is coarse, at a corner by
/// the same angle in any mesh: `kink` is what the tangents of the two sides, each continued to the point from the middles of
/// its last two edges (exact on a straight line and on a circle), leave of the turn. A curve of the drawing with one edge is
/// straight, and a turn of more than 55 degrees is a corner: no mesh resolves that.
struct OutlinePoint {
  bool known = false;  ///< one edge ends here and one starts
  double turn = 0;     ///< between these two, to the left positive [rad]
  double kink = 0;     ///< of the curves themselves [rad]; 0: there is no corner
  Vec2 before = Vec2::Zero(),
       after = Vec2::Zero();  ///< unit tangents of the two sides at the point; alike without a corner
};
std::vector<OutlinePoint> outline_of(const Midsurface& surface);

/// Order in h to which a mesh finds the deflection of a plate with a corner between two hinged edges that turns by `kink`
/// [rad], 2 at most: there it is as smooth as r^mu only, mu the least of k pi / angle and 2 - k pi / angle above 1
/// [blum1980], and the error falls as h^(2 (mu - 1)).
double order_at_corner(double kink);

/// Error that a mesh leaves in the deflection, over the deflection: `gap` where the outline is smooth or rectangular, h^2 in kind;
/// at corners, `kinks`, as much more as their order is less. Within a factor of 2 of the errors of a hexagon (5 and 10 edges a
/// side), a rhombus of 30 degrees and polygons of 12 sides; corners of less than 20 degrees count by their turn.
double with_corners(double gap, std::span<const double> kinks);

/// Points of the outline between two simply supported edges that are corners of an order below 2; where straight lines
/// stand for a curved edge it is another plate (Babuska's paradox). `support`: one a patch.
std::vector<Index> blunt_corners(const Midsurface& surface, const std::vector<OutlinePoint>& outline,
                                 const std::vector<Support>& support);

}  // namespace couplet::plate
