// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plate_modal/plate_model.hpp"

namespace couplet::plate {

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

/// Points of the outline between two simply supported edges that are corners of less than 55 degrees: the deflection there
/// is as smooth as r^(pi / angle) only, and where straight lines stand for a curved edge it is another plate (Babuska's
/// paradox). `support`: one a patch.
std::vector<Index> blunt_corners(const Midsurface& surface, const std::vector<OutlinePoint>& outline,
                                 const std::vector<Support>& support);

}  // namespace couplet::plate
