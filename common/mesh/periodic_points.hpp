// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Pairs periodic patches by the partner that each of them names. Throws Error with `boundaries.<patch>` if
/// two do not name each other.
std::vector<std::array<std::string, 2>> periodic_pairs(const std::map<std::string, std::string>& partner_of);

/// Copies of points on joined periodic patches. The mesh holds one copy on each side (four at an edge where
/// two pairs meet).
class PeriodicPoints {
 public:
  /// Finds the copies from the points as read and the shifts of the faces. Collective.
  explicit PeriodicPoints(const Mesh& mesh, const Geometry& geometry);

  bool empty() const { return n_groups_ == 0; }
  /// Local points that have copies, ghosts included.
  const std::vector<Index>& points() const { return points_; }
  /// Number of copies of points()[i].
  int copies(std::size_t i) const { return copies_[group_[i]]; }
  /// Number of the point that points()[i] is a copy of, the same on all ranks.
  Index group(std::size_t i) const { return group_[i]; }
  enum class Ghosts { leave_out, count };
  /// Replaces the values at copies by their sum. `values` has `stride` entries per local point. Count ghosts
  /// if each rank holds its own contribution. Collective.
  void add_up(std::span<double> values, int stride, Ghosts ghosts = Ghosts::leave_out) const;
  /// Largest distance between copies of a point, from `stride` values per local point. Collective.
  double largest_gap(std::span<const double> values, int stride) const;

 private:
  const Mesh& mesh_;
  std::size_t n_groups_ = 0;
  std::vector<Index> points_, group_;  // points, ascending, and the group of each
  std::vector<int> copies_;            // per group
};

}  // namespace couplet::mesh
