// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// A pressure that follows the surface: on a deformed face, the triangles (2-D: lines) between its node b and its
/// edges, -p a with the present area a (Nanson's formula, exactly), shared evenly by the corners of each. Its
/// tangent holds what the area changes: symmetric where the loaded surface is closed or its rim is held.
template <int D>
class FollowerPressure {
 public:
  /// `pressure` [Pa]: one a boundary face of owned cells; takes those that are not zero.
  void set(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::span<const double> pressure);
  bool empty() const { return faces_.empty(); }
  /// Adds -`sign` times the forces [N] at the present displacements, and keeps the places. Gives their sum, this
  /// rank's.
  Vec3 add_forces(SymmetricSpace<D>& space, double sign);
  /// Adds -`sign` times what they change by when the displacement changes by that in `space`.
  void add_tangent(SymmetricSpace<D>& space, double sign) const;

 private:
  struct Loaded {
    Index face;
    double pressure, orientation;  ///< 1: the corners turn about the outer normal
    std::array<Vec3, 5> place;     ///< of the node and the corners
  };
  void gather(const SymmetricSpace<D>& space, const Loaded& loaded, bool is_place,
              std::array<Vec3, 5>& to) const;
  void spread(SymmetricSpace<D>& space, const Loaded& loaded, const std::array<Vec3, 5>& forces) const;

  std::vector<Loaded> faces_;
};

}  // namespace couplet::elastic
