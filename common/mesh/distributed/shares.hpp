// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <span>
#include <vector>

#include "common/parallel/parcels.hpp"

namespace couplet::mesh {

/// Numbers 0 .. n - 1 in even shares, rank by rank, of the first `holders` ranks: where what has a number stands while
/// no rank owns it.
struct Shares {
  GlobalIndex n = 0;
  int ranks = 1;
  int holders = ranks;
  GlobalIndex first(int rank) const {
    rank = std::min(rank, holders);
    return n / holders * rank + std::min<GlobalIndex>(rank, n % holders);
  }
  GlobalIndex count(int rank) const { return first(rank + 1) - first(rank); }
  int rank_of(GlobalIndex i) const {
    const GlobalIndex least = n / holders, larger = n % holders, in_larger = (least + 1) * larger;
    return static_cast<int>(i < in_larger ? i / (least + 1) : larger + (i - in_larger) / least);
  }
};

/// `numbers`, ascending, as parcels to the ranks in whose shares they are.
inline parallel::Parcels<GlobalIndex> by_share(const Shares& shares, std::vector<GlobalIndex> numbers) {
  parallel::Parcels<GlobalIndex> parcels;
  for (int r = 0; r <= shares.ranks; ++r)
    parcels.first.push_back(
        std::size_t(std::ranges::lower_bound(numbers, shares.first(r)) - numbers.begin()));
  parcels.items = std::move(numbers);
  return parcels;
}

/// The values at these numbers, ascending, of which each rank has those of its share. Collective.
template <class T>
std::vector<T> fetch(MPI_Comm comm, const Shares& shares, std::span<const T> mine,
                     const std::vector<GlobalIndex>& numbers) {
  const auto asked = parallel::exchange(comm, by_share(shares, numbers));
  const GlobalIndex first = shares.first(parallel::comm_rank(comm));
  parallel::Parcels<T> answers{{}, asked.first};
  answers.items.reserve(asked.items.size());
  for (const GlobalIndex i : asked.items) answers.items.push_back(mine[i - first]);
  return std::move(parallel::exchange(comm, answers).items);
}

}  // namespace couplet::mesh
