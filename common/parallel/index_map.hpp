// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <cstddef>
#include <memory>
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

}  // namespace couplet::parallel
