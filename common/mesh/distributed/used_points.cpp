// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/used_points.hpp"

#include "common/parallel/collective.hpp"

namespace couplet::mesh {

void drop_unused_points(MPI_Comm comm, MeshBlock& block) {
  std::vector<GlobalIndex> all = block.cells.points;
  all.insert(all.end(), block.element_points.begin(), block.element_points.end());
  const PointNumbers here(all);
  all = {};
  const int rank = parallel::comm_rank(comm);
  const GlobalIndex first = block.point_shares.first(rank);
  std::vector<char> used(block.points.size(), 0);
  for (const GlobalIndex p : parallel::exchange(comm, by_share(block.point_shares, here.numbers())).items)
    used[std::size_t(p - first)] = 1;
  const auto kept = GlobalIndex(std::ranges::count(used, 1));
  const GlobalIndex total = parallel::sum(comm, kept);
  if (total == block.point_shares.n) return;
  std::vector<GlobalIndex> number(used.size(), -1);
  std::vector<Vec3> points;
  GlobalIndex next = parallel::exclusive_scan(comm, kept);
  const GlobalIndex first_kept = next;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    number[i] = next++;
    points.push_back(block.points[i]);
  }
  const std::vector<GlobalIndex> renumbered =
      fetch(comm, block.point_shares, std::span<const GlobalIndex>(number), here.numbers());
  for (auto* of : {&block.cells.points, &block.element_points})
    for (GlobalIndex& p : *of) p = renumbered[std::size_t(here.place(p))];
  block.point_shares = {total, block.point_shares.ranks};
  parallel::Parcels<Vec3> parcels;
  for (int r = 0; r <= block.point_shares.ranks; ++r)
    parcels.first.push_back(
        std::size_t(std::clamp(block.point_shares.first(r), first_kept, next) - first_kept));
  parcels.items = std::move(points);
  block.points = std::move(parallel::exchange(comm, parcels).items);
}

}  // namespace couplet::mesh
