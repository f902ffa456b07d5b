// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "plate_modal/plate_model.hpp"

namespace couplet::plate {

/// Where the outline has corners. Within a curve edges turn by as much as the mesh is coarse, at a corner by the same
/// angle in any mesh: what the tangents of the two sides, each continued to the point from the middles of its last two
/// edges (exact on a straight line and on a circle), leave of the turn. One: more than 0.6 of the turn and half a degree, or a
/// turn of more than 25 degrees, which no mesh resolves. A curve of the drawing with one edge is straight.
struct Outline {
  std::vector<bool> corner;  ///< of each point of the mid-surface
  std::vector<double>
      turn;  ///< between its two edges [rad]; 0: not on the outline, or more than two edges meet there
};
Outline outline_of(const Midsurface& surface);

/// Points of the outline between two simply supported edges that are corners of less than 25 degrees: a curved edge drawn by
/// straight lines, which is another plate (Babuska's paradox). `support`: one a patch.
std::vector<Index> blunt_corners(const Midsurface& surface, const Outline& outline,
                                 const std::vector<Support>& support);

}  // namespace couplet::plate
