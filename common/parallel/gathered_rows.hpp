// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <cstddef>
#include <numeric>
#include <vector>

#include "common/base/types.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::parallel {

/// Gathers the rows of all ranks on every rank, over and over without counting them again. MPI passes them on in a tree, so
/// that a rank sends to few others.
class GatheredRows {
 public:
  GatheredRows() = default;
  /// `rows`: of this rank, `size` bytes each. Collective.
  GatheredRows(MPI_Comm comm, Index rows, std::size_t size) : comm_(comm) {
    const std::vector<Index> of_rank = all_gather(comm, std::vector<Index>{rows});
    for (const Index r : of_rank) bytes_.push_back(static_cast<int>(std::size_t(r) * size));
    start_.resize(bytes_.size());
    std::exclusive_scan(bytes_.begin(), bytes_.end(), start_.begin(), 0);
    const auto here = of_rank.begin() + comm_rank(comm);
    first_ = std::accumulate(of_rank.begin(), here, Index(0));
    count_ = std::accumulate(here, of_rank.end(), first_);
  }
  /// First row of this rank, and the number of rows of all.
  Index first() const { return first_; }
  Index count() const { return count_; }
  /// Copies the rows `here` of each rank to `all`. Collective.
  void gather(const void* here, void* all) const {
    MPI_Allgatherv(here, bytes_[comm_rank(comm_)], MPI_BYTE, all, bytes_.data(), start_.data(), MPI_BYTE,
                   comm_);
  }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  std::vector<int> bytes_, start_;
  Index first_ = 0, count_ = 0;
};

}  // namespace couplet::parallel
