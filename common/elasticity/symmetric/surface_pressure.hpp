// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// A block between two places, see FaceRows.
struct PlaceBlock {
  Index i, j;
  Tensor3 block;
};

/// Stresses that act in a body before it moves on.
struct Prestress {
  std::vector<Tensor3> stress;       ///< per flux face [Pa], that of the trial functions: the kernel's own
  std::vector<PlaceBlock> pressure;  ///< of a pressure that follows the surface
};

/// Adds `factor` times the blocks' forces of the displacement in the space.
void add_blocks(SymmetricSpace& space, std::span<const PlaceBlock> blocks, double factor);

/// A pressure that follows the surface: on a deformed face, the triangles (2-D: lines) between its node b and its
/// edges, -p a with the present area a (Nanson's formula, exactly), shared evenly by the corners of each. Its
/// tangent holds what the area changes: symmetric where the loaded surface is closed or its rim is held. The inner
/// forces p a / 3 (1/2) on each corner give
///   K_rs = p / 6 [e_s]x,   e_s the side opposite to corner s;   in the plane K_rs = p / 2 da/du_s.
class FollowerPressure {
 public:
  struct Loaded {
    Index face;
    double pressure;  ///< its sign is that of the turn of the corners about the outer normal
  };
  /// `pressure` [Pa]: one a boundary face of owned cells; takes those that are not zero.
  void set(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::span<const double> pressure);
  bool empty() const { return faces_.empty(); }
  const std::vector<Loaded>& loaded() const { return faces_; }
  /// Adds the inner forces [N] at the present displacements, and keeps their tangent. Gives the sum of the forces on the
  /// body, this rank's.
  Vec3 add_forces(SymmetricSpace& space);
  /// Adds what they change by when the displacement changes by that in `space`.
  void add_tangent(SymmetricSpace& space) const { add_blocks(space, tangent_, 1); }

 private:
  std::vector<Loaded> faces_;
  std::vector<PlaceBlock> tangent_;
};

/// The symmetric part of the tangent of an undeformed body: all of it where the loaded surface is closed or its rim is held.
/// `pressure` [Pa]: one a boundary face of owned cells.
std::vector<PlaceBlock> pressure_stiffness(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           std::span<const double> pressure);

}  // namespace couplet::elastic
