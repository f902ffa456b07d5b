// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/point_directory.hpp"

#include <numeric>

namespace couplet::mesh {

PointDirectory::PointDirectory(MPI_Comm comm, const Shares& shares, const std::vector<GlobalIndex>& points)
    : comm_(comm), shares_(shares), first_(shares.first(parallel::comm_rank(comm))) {
  const auto told = parallel::exchange(comm, by_share(shares, points));
  ranks_.offset.assign(std::size_t(shares.count(parallel::comm_rank(comm))) + 1, 0);
  for (const GlobalIndex p : told.items) ++ranks_.offset[p - first_ + 1];
  std::partial_sum(ranks_.offset.begin(), ranks_.offset.end(), ranks_.offset.begin());
  ranks_.index.resize(told.items.size());
  std::vector<Index> next(ranks_.offset.begin(), ranks_.offset.end() - 1);
  for (int r = 0; r < shares.ranks; ++r)
    for (const GlobalIndex p : told.of(r)) ranks_.index[next[p - first_]++] = r;
}

Csr PointDirectory::ranks_at(const std::vector<GlobalIndex>& points) const {
  const auto asked = parallel::exchange(comm_, by_share(shares_, points));
  std::vector<std::size_t> count;
  for (int r = 0; r < shares_.ranks; ++r) {
    count.push_back(0);
    for (const GlobalIndex p : asked.of(r)) count.back() += 1 + ranks_[Index(p - first_)].size();
  }
  auto answers = parallel::make_parcels<Index>(count);
  auto to = answers.items.begin();
  for (const GlobalIndex p : asked.items) {
    const auto ranks = ranks_[Index(p - first_)];
    *to++ = static_cast<Index>(ranks.size());
    to = std::copy(ranks.begin(), ranks.end(), to);
  }
  const std::vector<Index> told = std::move(parallel::exchange(comm_, answers).items);
  Csr rows;
  rows.offset.reserve(points.size() + 1);
  for (auto at = told.begin(); at != told.end(); at += 1 + *at) rows.push_row({&*at + 1, std::size_t(*at)});
  return rows;
}

}  // namespace couplet::mesh
