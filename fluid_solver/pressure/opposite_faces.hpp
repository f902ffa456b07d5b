// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::fluid {

/// Pairs of wall faces on the two wet sides of a thin body. Found once, on the mesh at rest; the body carries
/// them.
class OppositeFaces {
 public:
  /// Part of a face and of the face opposite.
  struct Pair {
    Index face;   ///< boundary face, owned
    Index other;  ///< entry of the map: an owned boundary face, or a copy of another rank's
    double area;  ///< common area [m^2]
  };

  OppositeFaces() = default;
  /// `candidates`: owned boundary faces of such walls. A body is thin if its thickness is at most a quarter
  /// of their extent. Each pair appears once from either side. Collective.
  OppositeFaces(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::span<const Index> candidates);

  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Owned boundary faces, then copies of opposite faces from other ranks.
  const parallel::IndexMap& map() const { return map_; }
  /// Share of the candidates' area with an opposite face, over all ranks, and the mean thickness there [m].
  double share() const { return share_; }
  double thickness() const { return thickness_; }

 private:
  void balance(const std::vector<double>& covered);
  std::vector<Pair> pairs_;
  parallel::IndexMap map_;
  double share_ = 0, thickness_ = 0;
};

}  // namespace couplet::fluid
