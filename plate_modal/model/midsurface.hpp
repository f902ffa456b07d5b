// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"

namespace couplet::plate {

using Vec2 = Eigen::Vector2d;

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

}  // namespace couplet::plate
