// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Share of a segment, a triangle or a tetrahedron in which a level is above zero, and the integral of the level there,
/// over the size of the whole.
struct OpenPart {
  double share = 0, moment = 0;
};

/// A corner of one, and the level there.
struct LevelCorner {
  Vec3 place = Vec3::Zero();
  double level = 0;
};

using Level = std::function<double(const Vec3&)>;

/// Uses the places where the level is zero on the edges, of the level itself: a corner of the surface that lies on an edge, or an edge
/// along the surface, is met exactly; between the edges the surface is flat. `corners`: two, three or four. Levels up to
/// `round_off` count as zero.
OpenPart open_part(std::span<const LevelCorner> corners, const Level& level, double round_off);

/// A level [m] at the points and cells of a mesh, and anywhere.
struct Levels {
  std::span<const Vec3> points;  ///< per local point
  std::span<const double> at_points, at_centres;
  Level anywhere;
};

/// How the surface of bodies, where a level is zero, cuts the mesh, see open_part(): evenly as surface or mesh move. A plane is
/// met exactly. No face of a closed cell is open.
template <int D>
struct CutCells {
  std::vector<double> faces;       ///< open share, per flux face
  std::vector<double> cells;       ///< open share, per local cell
  std::vector<double> open_depth;  ///< mean level of the open part, per local cell [m]; 0: there is none
  /// Largest difference of the level from that at the centre, per local cell [m].
  std::vector<double> extent;
  Vectors<D> wall;  ///< surface in the cell, out of the open part, per local cell [m^2]
};

/// Collective.
template <int D>
CutCells<D> cut(const mesh::Mesh& mesh, const Placement<D>& at, const Levels& levels);

}  // namespace couplet::fluid
