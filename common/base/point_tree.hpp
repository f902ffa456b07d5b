// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace couplet::base
