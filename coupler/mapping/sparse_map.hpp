// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::coupler {

/// A linear map between two sets of places: target i is the sum of weight[k] times source[k] over
/// offset[i] <= k < offset[i + 1]. The same for each component of a vector.
struct SparseMap {
  std::size_t n_from = 0;
  std::vector<std::size_t> offset{0};
  std::vector<Index> source;
  std::vector<double> weight;

  std::size_t n_to() const { return offset.size() - 1; }
  void push_row(std::span<const Index> sources, std::span<const double> weights);
  std::vector<double> apply(std::span<const double> values, int components) const;
  /// From targets to sources with the same weights: what is shared out keeps its sum where all rows sum to 1.
  SparseMap transposed() const;
};

}  // namespace couplet::coupler
