// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// Block between two locations, see FaceRows.
struct PlaceBlock {
  Index i, j;
  Tensor3 block;
};

/// Initial stresses of a body and the tangent of its loads.
struct Prestress {
  std::vector<Tensor3> stress;    ///< per flux face [Pa], of the kernel's test functions
  std::vector<PlaceBlock> loads;  ///< change of the loads with the displacement
};

/// Adds `factor` times the forces of the blocks for the displacement in the space.
void add_blocks(SymmetricSpace& space, std::span<const PlaceBlock> blocks, double factor);

/// Follower pressure. A deformed face is divided into triangles (2-D: lines) between its node b and its
/// edges, with the force -p a on the current area a (Nanson's formula, exact). A corner takes an even share of a
/// with its own p. The tangent contains the change of area. It is symmetric if the loaded surface is closed or its
/// rim is fixed. The inner forces p a / 3 (1/2) per corner give
///   K_rs = p / 6 [e_s]x,   e_s the side opposite to corner s;   in 2-D K_rs = p / 2 da/du_s
class FollowerPressure {
 public:
  struct Loaded {
    Index face;
    /// At the node and the corners; positive if the corners turn counterclockwise about the outer normal.
    std::array<double, 5> pressure;
  };
  /// Sets the pressure [Pa], one per boundary face of owned cells. If it varies within faces, 3 (2-D) or 5 more per
  /// face follow, for its node and corners. Keeps nonzero ones.
  void set(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::span<const double> pressure);
  bool empty() const { return faces_.empty(); }
  const std::vector<Loaded>& loaded() const { return faces_; }
  /// Adds the inner forces [N] at the current displacements and stores their tangent. Returns the resultant
  /// force on the body, this rank's contribution.
  Vec3 add_forces(SymmetricSpace& space);
  /// Adds the change of the forces for the displacement increment in `space`.
  void add_tangent(SymmetricSpace& space) const { add_blocks(space, tangent_, 1); }

 private:
  std::vector<Loaded> faces_;
  std::vector<PlaceBlock> tangent_;
};

/// Symmetric part of the tangent of an undeformed body. It is complete if the loaded surface is closed or its
/// rim is fixed. `pressure` [Pa] is as in FollowerPressure::set().
std::vector<PlaceBlock> pressure_stiffness(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           std::span<const double> pressure);

}  // namespace couplet::elastic
