// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::fluid {

/// Which faces of a wall look at each other through a thin body: those of its two wet sides. Found once, on the mesh at
/// rest, which the body carries with it.
class OppositeFaces {
 public:
  /// A part of a face and of the one opposite.
  struct Pair {
    Index face;   ///< boundary face, owned
    Index other;  ///< entry of the map: an owned boundary face, or a copy of another rank's
    double area;  ///< that they have in common [m^2]
  };

  OppositeFaces() = default;
  /// `candidates`: owned boundary faces of such walls. A body is thin where it is no thicker than a quarter of their extent.
  /// Every pair of faces is here once from each side. Collective.
  OppositeFaces(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::span<const Index> candidates);

  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Owned boundary faces, then copies of other ranks' faces that lie opposite some.
  const parallel::IndexMap& map() const { return map_; }
  /// Share of the candidates' area that has a face opposite, over all ranks, and the mean thickness there [m].
  double share() const { return share_; }
  double thickness() const { return thickness_; }

 private:
  void balance(const std::vector<double>& covered);
  std::vector<Pair> pairs_;
  parallel::IndexMap map_;
  double share_ = 0, thickness_ = 0;
};

}  // namespace couplet::fluid
