// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <span>

#include "common/base/types.hpp"

namespace couplet::fluid {

/// Of a segment, a triangle or a tetrahedron: the share of it in which a level is above zero, and the integral of the level
/// there, over the size of the whole.
struct OpenPart {
  double share = 0, moment = 0;
};

/// A corner of one, and the level there.
struct LevelCorner {
  Vec3 place = Vec3::Zero();
  double level = 0;
};

using Level = std::function<double(const Vec3&)>;

/// By the places where the level is zero on the edges, of the level itself: a corner of the surface that lies on an edge, or an edge
/// along the surface, is met exactly; between the edges the surface is flat. `corners`: two, three or four. Levels up to
/// `round_off` count as zero.
OpenPart open_part(std::span<const LevelCorner> corners, const Level& level, double round_off);

}  // namespace couplet::fluid
