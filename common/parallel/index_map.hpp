// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::parallel {

/// Which entries of a distributed array live here: the owned ones first, then the ghosts (copies of entries
/// that another rank owns), and how to refresh the ghosts. Owned entries carry contiguous global numbers,
/// rank by rank, as PETSc wants them.
class IndexMap {
 public:
  IndexMap() = default;
  /// Collective. `ghost_owner[g]`: the rank that owns ghost g; `ghost_remote[g]`: its local (owned) index
  /// there.
  IndexMap(MPI_Comm comm, Index n_owned, const std::vector<int>& ghost_owner,
           const std::vector<Index>& ghost_remote);

  Index n_owned() const { return n_owned_; }
  Index n_ghost() const { return n_local_ - n_owned_; }
  Index n_local() const { return n_local_; }
  GlobalIndex n_global() const { return n_global_; }
  /// Global number of the first owned entry.
  GlobalIndex first() const { return first_; }
  /// Global number of a local entry, owned or ghost.
  GlobalIndex global(Index local) const { return global_[local]; }
  const std::vector<GlobalIndex>& global() const { return global_; }

  /// Overwrites the ghosts with their owners' values. `values`: n_local x components, entry by entry.
  /// Collective.
  void update_ghosts(std::span<double> values, int components = 1) const;
  void update_ghosts(std::span<GlobalIndex> values) const;
  /// The same of anything that may be copied byte by byte, `size` bytes an entry.
  void update_ghosts(std::span<std::byte> values, std::size_t size) const;
  /// Adds the ghosts' values into their owners (and leaves the ghosts as they are). Collective.
  void add_to_owners(std::span<double> values, int components = 1) const;

 private:
  struct Exchange;
  Index n_owned_ = 0, n_local_ = 0;
  GlobalIndex n_global_ = 0, first_ = 0;
  std::vector<GlobalIndex> global_;
  std::shared_ptr<const Exchange> exchange_;
};

/// The order of a distributed array by numbers of its entries that do not depend on the ranks. Each rank has one block of
/// rows of that order, so that all blocks, rank by rank, are the array as one rank alone would have it: what files hold.
/// No rank holds more than its block and its own entries.
class GlobalOrder {
 public:
  GlobalOrder() = default;
  /// `ids`: the number (0 or more) of each entry of this rank, of which the first `n_owned` are its own: each number is
  /// owned by one rank. Throws Error on all ranks if that is not so. Collective.
  GlobalOrder(MPI_Comm comm, std::span<const GlobalIndex> ids, std::size_t n_owned);
  /// `owned`: which entries are this rank's own.
  GlobalOrder(MPI_Comm comm, std::span<const GlobalIndex> ids, const std::vector<char>& owned);
  /// The n entries of each rank, rank by rank, in the order in which they are.
  static GlobalOrder as_they_are(MPI_Comm comm, std::size_t n);
  /// By these numbers, of entries that are all this rank's own, or, where they are missing or not unique, of the n entries as
  /// they are: numbers that a guest program may give or not. Collective.
  static GlobalOrder by_numbers(MPI_Comm comm, std::span<const GlobalIndex> ids, std::size_t n);
  /// Rows that stand rank by rank with these numbers, this rank reading as many as it has entries; its entries, all its own, have
  /// the numbers `ids`. Gives the order of the rows, or none where they stand as the entries do. Throws Error on all ranks if the
  /// numbers are not the same ones. Collective.
  static std::optional<GlobalOrder> of_rows(MPI_Comm comm, std::span<const GlobalIndex> rows,
                                            std::span<const GlobalIndex> ids);

  std::size_t n_local() const { return n_local_; }
  GlobalIndex n_global() const { return n_global_; }
  /// This rank's block.
  GlobalIndex first() const { return first_; }
  std::size_t count() const { return count_; }

  /// From `width` values per entry of this rank, its own entries' counting, to its block. Collective.
  std::vector<double> to_block(std::span<const double> values, std::size_t width) const;
  /// From the blocks to the entries of this rank, those that it does not own, too. Collective.
  std::vector<double> from_block(std::span<const double> block, std::size_t width) const;

 private:
  MPI_Comm comm_ = MPI_COMM_SELF;
  std::size_t n_local_ = 0, count_ = 0;
  GlobalIndex first_ = 0, n_global_ = 0;
  // By rank: entries here whose rows lie in that rank's block, and which of them are owned; rows of the block here of that
  // rank's entries, in its order.
  std::vector<std::vector<Index>> entries_, rows_;
  std::vector<std::vector<char>> owned_, owned_there_;
};

}  // namespace couplet::parallel
