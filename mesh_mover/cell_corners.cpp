// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/cell_corners.hpp"

#include <cmath>

namespace couplet::mesh_mover {

const CellCorners& corners_of(mesh::CellType type) {
  static const CellCorners triangle{
      {{0, 1}, {1, 2}, {2, 0}}, {{0, 1, 2, -1}, {1, 2, 0, -1}, {2, 0, 1, -1}}, 2 / std::sqrt(3.0)};
  static const CellCorners quadrilateral{{{0, 1}, {1, 2}, {2, 3}, {3, 0}},
                                         {{0, 1, 3, -1}, {1, 2, 0, -1}, {2, 3, 1, -1}, {3, 0, 2, -1}}};
  static const CellCorners tetrahedron{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
                                       {{0, 1, 2, 3}, {1, 2, 0, 3}, {2, 0, 1, 3}, {3, 0, 2, 1}},
                                       std::sqrt(2.0)};
  static const CellCorners hexahedron{
      {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
      {{0, 1, 3, 4},
       {1, 2, 0, 5},
       {2, 3, 1, 6},
       {3, 0, 2, 7},
       {4, 7, 5, 0},
       {5, 4, 6, 1},
       {6, 5, 7, 2},
       {7, 6, 4, 3}}};
  static const CellCorners prism{
      {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}},
      {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}},
      2 / std::sqrt(3.0)};
  static const CellCorners pyramid{{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
                                   {{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}},
                                   std::sqrt(2.0)};
  switch (type) {
    case mesh::CellType::triangle:
      return triangle;
    case mesh::CellType::quadrilateral:
      return quadrilateral;
    case mesh::CellType::tetrahedron:
      return tetrahedron;
    case mesh::CellType::hexahedron:
      return hexahedron;
    case mesh::CellType::prism:
      return prism;
    case mesh::CellType::pyramid:
      return pyramid;
  }
  return triangle;
}

}  // namespace couplet::mesh_mover
