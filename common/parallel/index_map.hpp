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

/// Local part of a distributed array: owned entries, then ghosts (copies of entries of other ranks), with
/// their updates. Owned entries have contiguous global numbers, rank by rank, as PETSc requires.
class IndexMap {
 public:
  IndexMap() = default;
  /// `ghost_owner[g]` is the rank that owns ghost g, `ghost_remote[g]` its local (owned) index there.
  /// Collective.
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

  /// Copies the owners' values to the ghosts. `values` has n_local x components. Collective.
  void update_ghosts(std::span<double> values, int components = 1) const;
  void update_ghosts(std::span<GlobalIndex> values) const;
  /// Overload for trivially copyable entries of `size` bytes.
  void update_ghosts(std::span<std::byte> values, std::size_t size) const;
  /// Adds the ghosts' values to their owners without changing the ghosts. Collective.
  void add_to_owners(std::span<double> values, int components = 1) const;

 private:
  struct Exchange;
  Index n_owned_ = 0, n_local_ = 0;
  GlobalIndex n_global_ = 0, first_ = 0;
  std::vector<GlobalIndex> global_;
  std::shared_ptr<const Exchange> exchange_;
};

/// Order of a distributed array by numbers that do not depend on the partition. Each rank has one block of
/// rows. All blocks together, rank by rank, are the array as a single rank would store it, as in files. No
/// rank holds more than its block and its own entries.
class GlobalOrder {
 public:
  GlobalOrder() = default;
  /// `ids` holds the number (0 or more) of each entry, of which the first `n_owned` are owned. Each number
  /// must be owned by one rank; otherwise throws Error on all ranks. Collective.
  GlobalOrder(MPI_Comm comm, std::span<const GlobalIndex> ids, std::size_t n_owned);
  /// `owned` flags the entries that this rank owns.
  GlobalOrder(MPI_Comm comm, std::span<const GlobalIndex> ids, const std::vector<char>& owned);
  /// Concatenates the n entries of each rank in their current order.
  static GlobalOrder as_they_are(MPI_Comm comm, std::size_t n);
  /// Orders entries owned by this rank by their numbers. If numbers are missing or not unique, as from a
  /// guest program, the current order is kept. Collective.
  static GlobalOrder by_numbers(MPI_Comm comm, std::span<const GlobalIndex> ids, std::size_t n);
  /// Order of rows that are stored rank by rank with the numbers `rows`, as many as this rank's (owned)
  /// entries with the numbers `ids`. Returns nothing if both orders agree. Throws Error on all ranks if the
  /// sets of numbers differ. Collective.
  static std::optional<GlobalOrder> of_rows(MPI_Comm comm, std::span<const GlobalIndex> rows,
                                            std::span<const GlobalIndex> ids);

  std::size_t n_local() const { return n_local_; }
  GlobalIndex n_global() const { return n_global_; }
  /// First row and number of rows of this rank's block.
  GlobalIndex first() const { return first_; }
  std::size_t count() const { return count_; }

  /// Sends the owned entries of `values` (`width` per local entry) to the blocks. Collective.
  std::vector<double> to_block(std::span<const double> values, std::size_t width) const;
  /// Sends rows of the blocks to all entries of this rank, including ghosts. Collective.
  std::vector<double> from_block(std::span<const double> block, std::size_t width) const;

 private:
  MPI_Comm comm_ = MPI_COMM_SELF;
  std::size_t n_local_ = 0, count_ = 0;
  GlobalIndex first_ = 0, n_global_ = 0;
  // Per rank: local entries with rows in its block and whether they are owned, and the local rows of its
  // entries in its order.
  std::vector<std::vector<Index>> entries_, rows_;
  std::vector<std::vector<char>> owned_, owned_there_;
};

}  // namespace couplet::parallel
