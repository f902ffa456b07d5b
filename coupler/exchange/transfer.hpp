// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/coupling/messages.hpp"

namespace couplet::coupler {

/// A sparse matrix between two lists of places that are cut over the coupler's ranks. It is built once; what
/// a rank needs of the others' values it asks for once, too.
class Transfer {
 public:
  struct Entry {
    GlobalIndex target, source;  ///< positions in the lists
    double weight;
  };
  Transfer() = default;
  /// Entries may be given on any rank; equal ones add up. Collective.
  Transfer(MPI_Comm comm, const coupling::Starts& targets, const coupling::Starts& sources,
           std::vector<Entry> entries);

  /// Values at this rank's sources to this rank's targets, `components` each. Collective.
  std::vector<double> apply(std::span<const double> values, int components) const;

 private:
  std::vector<double> fetch(std::span<const double> values, int components) const;

  MPI_Comm comm_ = MPI_COMM_SELF;
  std::size_t n_sources_ = 0;
  std::vector<std::size_t> first_{0};  // of each target's entries
  std::vector<Index> column_;          // this rank's sources, then those that are fetched
  std::vector<double> weight_;
  std::vector<std::vector<std::size_t>> give_;  // by rank: which of my sources it needs
  std::vector<int> take_;                       // by rank: how many I get from it
  bool alone_ = true, same_ = false;            // same: each target is the source at its place, on one rank
};

/// Ascending by target, then by source.
inline bool by_row(const Transfer::Entry& a, const Transfer::Entry& b) {
  return a.target != b.target ? a.target < b.target : a.source < b.source;
}

/// Every entry on the rank that has its target, by target and source, each pair once. Collective.
std::vector<Transfer::Entry> by_owner(MPI_Comm comm, const coupling::Starts& targets,
                                      std::vector<Transfer::Entry> entries);
/// The same weights from targets to sources.
std::vector<Transfer::Entry> transposed(std::vector<Transfer::Entry> entries);

/// Entries of the map that does `first` and then `second`, where the targets of the one are the sources of the
/// other, cut over the ranks as `between` says. Entries may be on any rank; those of the product are on the rank that has
/// those of `second`, each pair once there: row by row, so that no rank holds more than its rows of both maps and of the
/// product. Collective.
std::vector<Transfer::Entry> product(MPI_Comm comm, const coupling::Starts& between,
                                     const std::vector<Transfer::Entry>& second,
                                     const std::vector<Transfer::Entry>& first);

}  // namespace couplet::coupler
