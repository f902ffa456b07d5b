// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fluid_solver/motion/open_part.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

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
  std::vector<double>
      extent;       ///< largest difference of the level from that at the centre, per local cell [m]
  Vectors<D> wall;  ///< surface in the cell, out of the open part, per local cell [m^2]
};

/// Collective.
template <int D>
CutCells<D> cut(const mesh::Mesh& mesh, const Placement<D>& at, const Levels& levels);

}  // namespace couplet::fluid
