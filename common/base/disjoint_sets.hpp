// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::base {

/// Disjoint sets of the numbers 0 to n - 1, which are joined pair by pair.
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : up_(std::size_t(n)) { std::iota(up_.begin(), up_.end(), Index(0)); }
  /// Smallest member of the set that contains i.
  Index find(Index i) {
    while (up_[std::size_t(i)] != i) i = up_[std::size_t(i)] = up_[std::size_t(up_[std::size_t(i)])];
    return i;
  }
  void join(Index a, Index b) {
    a = find(a), b = find(b);
    up_[std::size_t(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<Index> up_;
};

}  // namespace couplet::base
