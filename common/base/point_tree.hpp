// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::base {

/// Nearest points by a k-d tree: n log n to build, log n a question. The points must outlive it.
class PointTree {
 public:
  explicit PointTree(const std::vector<Vec3>& points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  /// The k nearest, or all if there are fewer, nearest first; of those equally far (to rounding) the smaller
  /// index first, so that the choice does not depend on what else is in the tree.
  std::vector<Index> nearest(const Vec3& p, std::size_t k) const;
  /// All within this distance [m], in no order.
  std::vector<Index> within(const Vec3& p, double distance) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The place of a segment (n = 2) or a triangle (n = 3) that lies nearest to a point.
template <int n>
struct Nearest {
  std::array<double, n> weights{};  ///< of the corners: from 0 to 1, their sum is 1
  Vec3 place = Vec3::Zero();        ///< [m]
  double distance = 0;              ///< of the point from it [m]
};

/// Of the segment a-b from x [m]; a segment without length is a point.
Nearest<2> nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& x);

/// Of the triangle a-b-c from x [m]; a triangle without area is its edges. Barycentric coordinates from the areas
/// of the parts (Ericson, Real-Time Collision Detection, 2005, section 3.4), then the edges.
Nearest<3> nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

}  // namespace couplet::base
