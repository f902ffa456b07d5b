// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/mesh_block.hpp"

#include "common/mesh/topology.hpp"

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

MeshBlock block_of(MPI_Comm comm, RawMesh raw) {
  drop_unused_points(raw);
  const int ranks = parallel::comm_size(comm), rank = parallel::comm_rank(comm);
  MeshBlock block;
  block.dim = raw.dim;
  block.point_shares = {GlobalIndex(raw.points.size()), ranks};
  block.cell_shares = {GlobalIndex(raw.cell_type.size()), ranks};
  const Shares elements{GlobalIndex(raw.boundary_patch.size()), ranks};
  block.points.assign(raw.points.begin() + block.point_shares.first(rank),
                      raw.points.begin() + block.point_shares.first(rank + 1));
  std::vector<GlobalIndex> points;
  for (GlobalIndex c = block.cell_shares.first(rank); c < block.cell_shares.first(rank + 1); ++c) {
    const auto row = raw.cell_points[Index(c)];
    points.assign(row.begin(), row.end());
    block.push_cell(raw.cell_type[c], raw.cell_zone[c], points);
  }
  for (GlobalIndex e = elements.first(rank); e < elements.first(rank + 1); ++e) {
    const auto row = raw.boundary_points[Index(e)];
    points.assign(row.begin(), row.end());
    block.push_element(raw.boundary_patch[e], points);
  }
  block.zones = raw.zones, block.patches = raw.patches;
  block.periodic = raw.periodic, block.materials = raw.materials;
  block.find_wide_points = raw.find_wide_points;
  return block;
}

}  // namespace couplet::mesh
