// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Faces of a cell type as positions in the cell's point list, turning right-handed about the outward normal.
/// Point order: VTK and gmsh agree on it (prism: the normal of points 0 1 2 looks towards points 3 4 5).
/// 2-D: a face is an edge (a, b) whose outward normal is (dy, -dx) of b - a, for cells that turn
/// anticlockwise.
struct CellShape {
  int dim, n_points, n_faces;
  std::array<std::array<std::int8_t, 4>, 6> faces;  ///< -1: no such point
  std::array<std::int8_t, 8> mirrored;  ///< point order that turns an inverted cell right side out
  int face_size(int face) const {
    if (dim == 2) return 2;
    return faces[face][3] < 0 ? 3 : 4;
  }
};

const CellShape& shape_of(CellType type);
const char* name_of(CellType type);

}  // namespace couplet::mesh
