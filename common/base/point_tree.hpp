// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::base {

/// k-d tree for nearest points: n log n to build, log n per query. The points must outlive it.
class PointTree {
 public:
  explicit PointTree(const std::vector<Vec3>& points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  /// The k nearest points, nearest first, or all if there are fewer. Points at the same distance (to
  /// round-off) are sorted by index, so the result does not depend on other points in the tree.
  std::vector<Index> nearest(const Vec3& p, std::size_t k) const;
  /// The nearest point and all others at the same distance (to round-off), unsorted.
  std::vector<Index> closest(const Vec3& p) const;
  /// All points within this distance [m], unsorted.
  std::vector<Index> within(const Vec3& p, double distance) const;

 private:
  struct TreeState;
  std::unique_ptr<TreeState> state_;
};

/// Point of a segment (n = 2) or triangle (n = 3) that is nearest to another point.
template <int n>
struct NearestPoint {
  std::array<double, n> weights{};  ///< barycentric coordinates: from 0 to 1, their sum is 1
  Vec3 place = Vec3::Zero();        ///< [m]
  double distance = 0;              ///< to the other point [m]
};

/// Point of the segment a-b that is nearest to x [m]. A segment without length is a point.
NearestPoint<2> nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& x);

/// Point of the triangle a-b-c that is nearest to x [m]. Uses barycentric coordinates from areas (Ericson,
/// Real-Time Collision Detection, 2005, section 3.4), then the edges.
NearestPoint<3> nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

}  // namespace couplet::base
