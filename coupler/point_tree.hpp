// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/base/types.hpp"

namespace couplet {

/// Nearest points by a k-d tree: n log n to build, log n a question. The points must outlive it.
class PointTree {
 public:
  explicit PointTree(const std::vector<Vec3>& points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  struct Found {
    Index index = -1;
    double distance = 0;  ///< [m]
  };
  Found nearest(const Vec3& p) const;
  /// The k nearest, or all if there are fewer, nearest first.
  std::vector<Index> nearest(const Vec3& p, std::size_t k) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace couplet
