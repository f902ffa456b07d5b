// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <vector>

#include "common/parallel/parcels.hpp"

namespace couplet::coupler {

/// Every item on the rank that has it, owner(item); there those of rank 0 first, of each rank in the order in which it had
/// them. Nothing is sent where all are there. Items are copied as bytes. Collective.
template <class Item, class Owner>
std::vector<Item> to_owners(MPI_Comm comm, std::vector<Item> items, const Owner& owner) {
  const int rank = parallel::comm_rank(comm);
  const bool stay = std::ranges::all_of(items, [&](const Item& item) { return int(owner(item)) == rank; });
  if (!parallel::any(comm, !stay)) return items;
  const parallel::Parcels<Item> out = parallel::sort_by_rank(comm, items, owner);
  std::vector<Item>().swap(items);
  return parallel::exchange(comm, out).items;
}

}  // namespace couplet::coupler
