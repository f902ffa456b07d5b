// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Pairs of periodic patches from the partner that each of them names. Throws Error, with `boundaries.<patch>`, if two
/// do not name each other.
std::vector<std::array<std::string, 2>> periodic_pairs(const std::map<std::string, std::string>& partner_of);

/// Points that are one and the same across joined periodic patches: the mesh holds a copy of it on each side (four at
/// an edge where two pairs meet).
class PeriodicPoints {
 public:
  /// From the points as read and the shifts of the faces. Collective.
  explicit PeriodicPoints(const Mesh& mesh, const Geometry& geometry);

  bool empty() const { return n_groups_ == 0; }
  /// Local points that have copies, ghosts among them.
  const std::vector<Index>& points() const { return points_; }
  /// How many copies there are of points()[i].
  int copies(std::size_t i) const { return copies_[group_[i]]; }
  /// The point that points()[i] is, by a number that is the same on all ranks.
  Index group(std::size_t i) const { return group_[i]; }
  enum class Ghosts { leave_out, count };
  /// Puts the sum over its copies at each point that has some. `values`: `stride` per local point; those of ghosts count
  /// where each rank holds a part of its own. Collective.
  void add_up(std::span<double> values, int stride, Ghosts ghosts = Ghosts::leave_out) const;
  /// Largest distance of copies that should have moved alike, from `stride` values per local point. Collective.
  double largest_gap(std::span<const double> values, int stride) const;

 private:
  const Mesh& mesh_;
  std::size_t n_groups_ = 0;
  std::vector<Index> points_, group_;  // of points_: which of the groups; ascending points
  std::vector<int> copies_;            // per group
};

}  // namespace couplet::mesh
