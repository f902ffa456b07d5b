// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// A block between two places: local nodes (cells, then boundary faces), then local vertices.
struct PlaceBlock {
  Index i, j;
  Tensor3 block;
};

/// Stresses that act in a body before it moves on.
struct Prestress {
  std::vector<Tensor3> stress;       ///< per flux face [Pa], that of the trial functions: the kernel's own
  std::vector<PlaceBlock> pressure;  ///< of a pressure that follows the surface
};

/// What a pressure that follows the surface adds to the stiffness of an undeformed body: on the triangles (in the plane: lines)
/// between a face's node and its edges the force on each corner is -p a / 3 (1/2) with the area vector a, hence
///   K_rs = p / 6 [e_s]x,   e_s the side opposite to corner s;   in the plane K_rs = p / 2 da/du_s.
/// The symmetric part: all of it where the loaded surface is closed or its rim is held. `pressure` [Pa]: one a boundary
/// face of owned cells.
std::vector<PlaceBlock> pressure_stiffness(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           std::span<const double> pressure);

}  // namespace couplet::elastic
