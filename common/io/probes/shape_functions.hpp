// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Values of the shape functions of a cell at one place, one a cell point in VTK order. They sum to one and,
/// summed over the points' coordinates, give the place: so they interpolate linear fields exactly.
struct ShapeValues {
  std::array<double, 8> weight{};
  std::array<Vec3, 8> gradient{};  ///< by the reference coordinates
};
ShapeValues shape_functions(mesh::CellType type, const Vec3& reference);

/// The weights of the cell's points at `place`, or nothing when the place is outside the cell by more than
/// `slack` (in reference coordinates, where the cell has about unit size). A triangle or quadrilateral is
/// taken in the plane z = 0.
std::optional<std::array<double, 8>> weights_in_cell(mesh::CellType type, std::span<const Vec3> points,
                                                     const Vec3& place, double slack);

}  // namespace couplet::io
