// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "common/parallel/collective.hpp"

namespace couplet::coupler {

/// Every item on the rank that has it, owner(item); there those of rank 0 first, of each rank in the order in which it had
/// them. What stays is copied once and not sent. Items are copied as bytes. Collective.
template <class Item, class Owner>
std::vector<Item> to_owners(MPI_Comm comm, std::vector<Item> items, const Owner& owner) {
  const int ranks = parallel::comm_size(comm), rank = parallel::comm_rank(comm);
  if (ranks == 1) return items;
  std::vector<int> give(std::size_t(ranks), 0), take(give), give_at(std::size_t(ranks) + 1, 0),
      take_at(give_at);
  for (const Item& item : items) ++give[std::size_t(owner(item))];
  if (!parallel::any(comm, std::size_t(give[std::size_t(rank)]) != items.size())) return items;
  MPI_Alltoall(give.data(), 1, MPI_INT, take.data(), 1, MPI_INT, comm);
  give[std::size_t(rank)] = 0;
  for (std::size_t r = 0; r < std::size_t(ranks); ++r)
    give_at[r + 1] = give_at[r] + give[r], take_at[r + 1] = take_at[r] + take[r];
  std::vector<Item> out(std::size_t(give_at.back())), in(std::size_t(take_at.back()));
  auto next = give_at;
  std::size_t kept = std::size_t(take_at[std::size_t(rank)]);
  for (const Item& item : items)
    if (const auto r = std::size_t(owner(item)); r == std::size_t(rank))
      in[kept++] = item;
    else
      out[std::size_t(next[r]++)] = item;
  std::vector<Item>().swap(items);
  take[std::size_t(rank)] = 0;
  MPI_Datatype type;
  MPI_Type_contiguous(int(sizeof(Item)), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Alltoallv(out.data(), give.data(), give_at.data(), type, in.data(), take.data(), take_at.data(), type,
                comm);
  MPI_Type_free(&type);
  return in;
}

}  // namespace couplet::coupler
