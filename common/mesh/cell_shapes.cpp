// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/cell_shapes.hpp"

namespace couplet::mesh {
namespace {

constexpr CellShape triangle{2, 3, 3, {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}}}, {0, 2, 1}};
constexpr CellShape quadrilateral{
    2, 4, 4, {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}}}, {0, 3, 2, 1}};
constexpr CellShape tetrahedron{
    3, 4, 4, {{{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}}}, {0, 2, 1, 3}};
constexpr CellShape hexahedron{
    3,
    8,
    6,
    {{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
    {0, 3, 2, 1, 4, 7, 6, 5}};
constexpr CellShape prism{
    3, 6, 5, {{{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}}, {0, 2, 1, 3, 5, 4}};
constexpr CellShape pyramid{
    3, 5, 5, {{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}}, {0, 3, 2, 1, 4}};

}  // namespace

const CellShape& shape_of(CellType type) {
  static constexpr std::array<const CellShape*, 6> shapes{&triangle,   &quadrilateral, &tetrahedron,
                                                          &hexahedron, &prism,         &pyramid};
  return *shapes[static_cast<std::size_t>(type)];
}

const char* name_of(CellType type) {
  static constexpr std::array<const char*, 6> names{"triangle",   "quadrilateral", "tetrahedron",
                                                    "hexahedron", "prism",         "pyramid"};
  return names[static_cast<std::size_t>(type)];
}

}  // namespace couplet::mesh
