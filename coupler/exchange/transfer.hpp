// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/coupling/messages.hpp"

namespace couplet::coupler {

/// Sparse matrix between two lists of places distributed over the coupler's ranks. It is built once,
/// including the communication pattern.
class Transfer {
 public:
  struct Entry {
    GlobalIndex target, source;  ///< positions in the lists
    double weight;
  };
  Transfer() = default;
  /// Entries may be given on any rank; equal ones are summed. Collective.
  Transfer(MPI_Comm comm, const coupling::Starts& targets, const coupling::Starts& sources,
           std::vector<Entry> entries);

  /// Maps values at this rank's sources to its targets, `components` each. Collective.
  std::vector<double> apply(std::span<const double> values, int components) const;

 private:
  std::vector<double> fetch(std::span<const double> values, int components) const;

  MPI_Comm comm_ = MPI_COMM_SELF;
  std::size_t n_sources_ = 0;
  std::vector<std::size_t> first_{0};  // start of each target's entries
  std::vector<Index> column_;          // this rank's sources, then those received
  std::vector<double> weight_;
  std::vector<std::vector<std::size_t>> give_;  // by rank: sources of this rank that it needs
  std::vector<int> take_;                       // by rank: number of values received from it
  bool alone_ = true, same_ = false;  // same: each target equals the source at its place, on one rank
};

/// Orders by target, then by source.
inline bool by_row(const Transfer::Entry& a, const Transfer::Entry& b) {
  return a.target != b.target ? a.target < b.target : a.source < b.source;
}

/// Sends each entry to the rank of its target, sorted; equal ones are summed. Collective.
std::vector<Transfer::Entry> by_owner(MPI_Comm comm, const coupling::Starts& targets,
                                      std::vector<Transfer::Entry> entries);
/// Exchanges targets and sources; the weights remain.
std::vector<Transfer::Entry> transposed(std::vector<Transfer::Entry> entries);

/// Entries of the map `first` followed by `second`, where the targets of the former are the sources of the
/// latter, distributed over the ranks as `between`. Entries may be on any rank. Those of the product are on
/// the ranks of `second`, each pair once there. It works row by row, so that each rank stores only its rows
/// of the maps and the product. Collective.
std::vector<Transfer::Entry> product(MPI_Comm comm, const coupling::Starts& between,
                                     const std::vector<Transfer::Entry>& second,
                                     const std::vector<Transfer::Entry>& first);

}  // namespace couplet::coupler
