// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh_mover {

using CellEdge = std::array<int, 2>;
/// The corner, then the ends of its edges: right-handed in a good cell; -1 in two dimensions.
using CellCorner = std::array<int, 4>;

/// Edges and corners of a kind of cell in VTK order. Corners of a pyramid: those of its base, the apex has four edges.
struct CellCorners {
  std::vector<CellEdge> edges;
  std::vector<CellCorner> corners;
  double scale = 1;  ///< of the Jacobian of the ideal cell
};
const CellCorners& corners_of(mesh::CellType type);

}  // namespace couplet::mesh_mover
