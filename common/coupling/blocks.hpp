// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::coupling {

/// A list cut into contiguous blocks, rank by rank: entries starts[r] to starts[r + 1] are rank r's.
using Starts = std::vector<GlobalIndex>;

inline Starts starts_of(const std::vector<GlobalIndex>& counts) {
  Starts starts{0};
  for (const GlobalIndex n : counts) starts.push_back(starts.back() + n);
  return starts;
}

/// n entries on `ranks` ranks: rank r has [n r / ranks, n (r + 1) / ranks).
inline Starts even_starts(GlobalIndex n, int ranks) {
  Starts starts;
  for (int r = 0; r <= ranks; ++r) starts.push_back(n * r / ranks);
  return starts;
}

inline int owner_of(const Starts& starts, GlobalIndex position) {
  return int(std::upper_bound(starts.begin(), starts.end(), position) - starts.begin()) - 1;
}

/// The part of my block that lies in another rank's block of the same list, cut differently.
struct Overlap {
  int rank;                  ///< the other one
  std::size_t first, count;  ///< within my block
};

inline std::vector<Overlap> overlaps(const Starts& mine, int rank, const Starts& theirs) {
  std::vector<Overlap> result;
  const GlobalIndex low = mine[std::size_t(rank)], high = mine[std::size_t(rank) + 1];
  for (std::size_t r = 0; r + 1 < theirs.size(); ++r) {
    const GlobalIndex first = std::max(low, theirs[r]), end = std::min(high, theirs[r + 1]);
    if (first < end) result.push_back({int(r), std::size_t(first - low), std::size_t(end - first)});
  }
  return result;
}

}  // namespace couplet::coupling
