// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/mesh_block.hpp"

#include "common/mesh/load.hpp"

namespace couplet::mesh {

void MeshBlock::push_cell(CellType type, int zone, std::span<const GlobalIndex> cell_points) {
  cells.type.push_back(type);
  cells.zone.push_back(zone);
  cells.points.insert(cells.points.end(), cell_points.begin(), cell_points.end());
  cells.point_offset.push_back(static_cast<Index>(cells.points.size()));
}

void MeshBlock::push_element(int patch, std::span<const GlobalIndex> points_of_element) {
  element_patch.push_back(patch);
  element_points.insert(element_points.end(), points_of_element.begin(), points_of_element.end());
  element_offset.push_back(static_cast<Index>(element_points.size()));
}

MeshBlock block_of(MPI_Comm comm, const RawMesh& raw, int holders) {
  const int ranks = parallel::comm_size(comm), rank = parallel::comm_rank(comm);
  std::array<GlobalIndex, 7> counts{raw.dim,
                                    GlobalIndex(raw.points.size()),
                                    GlobalIndex(raw.cell_type.size()),
                                    GlobalIndex(raw.boundary_patch.size()),
                                    GlobalIndex(raw.periodic.size()),
                                    GlobalIndex(raw.materials.size()),
                                    raw.find_wide_points ? 1 : 0};
  MPI_Bcast(counts.data(), int(counts.size()), MPI_INT64_T, 0, comm);
  MeshBlock block;
  block.dim = static_cast<int>(counts[0]);
  block.point_shares = {counts[1], ranks, holders};
  block.cell_shares = {counts[2], ranks, holders};
  block.zones = raw.zones, block.patches = raw.patches;
  broadcast(comm, block.zones), broadcast(comm, block.patches);
  block.periodic = raw.periodic, block.materials = raw.materials;
  block.periodic.resize(std::size_t(counts[4])), block.materials.resize(std::size_t(counts[5]));
  for (auto& [side, other] : block.periodic)
    parallel::broadcast(comm, side), parallel::broadcast(comm, other);
  for (auto& material : block.materials) broadcast(comm, material);
  block.find_wide_points = counts[6] != 0;
  if (rank >= holders) return block;
  block.points.assign(raw.points.begin() + block.point_shares.first(rank),
                      raw.points.begin() + block.point_shares.first(rank + 1));
  std::vector<GlobalIndex> points;
  for (GlobalIndex c = block.cell_shares.first(rank); c < block.cell_shares.first(rank + 1); ++c) {
    const auto row = raw.cell_points[Index(c)];
    points.assign(row.begin(), row.end());
    block.push_cell(raw.cell_type[c], raw.cell_zone[c], points);
  }
  const Shares elements{counts[3], ranks, holders};
  for (GlobalIndex e = elements.first(rank); e < elements.first(rank + 1); ++e) {
    const auto row = raw.boundary_points[Index(e)];
    points.assign(row.begin(), row.end());
    block.push_element(raw.boundary_patch[e], points);
  }
  return block;
}

RawMesh raw_of(MeshBlock block) {
  RawMesh raw;
  raw.dim = block.dim;
  raw.points = std::move(block.points);
  raw.cell_type = std::move(block.cells.type);
  raw.cell_points = {std::move(block.cells.point_offset),
                     {block.cells.points.begin(), block.cells.points.end()}};
  raw.cell_zone = std::move(block.cells.zone);
  raw.boundary_points = {std::move(block.element_offset),
                         {block.element_points.begin(), block.element_points.end()}};
  raw.boundary_patch = std::move(block.element_patch);
  raw.zones = std::move(block.zones), raw.patches = std::move(block.patches);
  raw.periodic = std::move(block.periodic), raw.materials = std::move(block.materials);
  raw.find_wide_points = block.find_wide_points;
  return raw;
}

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
  block.point_shares.n = total;
  parallel::Parcels<Vec3> parcels;
  for (int r = 0; r <= block.point_shares.ranks; ++r)
    parcels.first.push_back(
        std::size_t(std::clamp(block.point_shares.first(r), first_kept, next) - first_kept));
  parcels.items = std::move(points);
  block.points = std::move(parallel::exchange(comm, parcels).items);
}

}  // namespace couplet::mesh
