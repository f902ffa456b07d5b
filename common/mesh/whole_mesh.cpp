// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/whole_mesh.hpp"

#include <algorithm>

#include "common/mesh/on_root.hpp"
#include "common/mesh/partition.hpp"

namespace couplet::mesh {
namespace {

double diagonal_of(const std::vector<Vec3>& points) {
  Vec3 low = points[0], high = low;
  for (const Vec3& x : points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  return (high - low).norm();
}

}  // namespace

WholeMesh make_whole_mesh(MPI_Comm comm, const RawMesh& raw) {
  WholeMesh whole;
  on_root(comm, [&] {
    whole.raw = raw;
    drop_unused_points(whole.raw);
    orient_cells(whole.raw);
    if (whole.raw.dim == 2) check_plane(whole.raw.points, diagonal_of(whole.raw.points));
    whole.faces = build_faces(whole.raw);
    whole.cell_material = materials_of_cells(whole.raw);
    split_materials(whole.raw, whole.faces, whole.cell_material);
    join_periodic(whole.raw, whole.faces);
    const Index n = whole.raw.cell_points.size();
    if (n < parallel::comm_size(comm))
      throw Error("The mesh has {} cells, fewer than the {} ranks that share it. Start fewer processes.", n,
                  parallel::comm_size(comm));
    const CellPairs pairs = connected_cells(whole.faces);
    whole.part = partition(make_graph(n, pairs.first, pairs.second), parallel::comm_size(comm));
    whole.raw.boundary_points = {};  // now in `faces`
    if (whole.raw.find_wide_points)
      whole.wide_points = wide_points(whole.raw, whole.faces, whole.cell_material);
  });
  if (parallel::comm_size(comm) == 1) return whole;
  MPI_Bcast(&whole.raw.dim, 1, MPI_INT, 0, comm);
  broadcast(comm, whole.raw.points);
  broadcast(comm, whole.raw.cell_type);
  broadcast(comm, whole.raw.cell_points);
  broadcast(comm, whole.raw.cell_zone);
  broadcast(comm, whole.raw.zones);
  broadcast(comm, whole.raw.patches);
  MPI_Bcast(&whole.faces.n_interior, 1, MPI_INT32_T, 0, comm);
  broadcast(comm, whole.faces.points);
  broadcast(comm, whole.faces.owner);
  broadcast(comm, whole.faces.neighbour);
  broadcast(comm, whole.faces.patch);
  broadcast(comm, whole.faces.shift);
  MPI_Bcast(&whole.faces.first_bonded, 1, MPI_INT64_T, 0, comm);
  broadcast(comm, whole.cell_material);
  broadcast(comm, whole.part);
  broadcast(comm, whole.wide_points);
  return whole;
}

parallel::IndexMap make_index_map(MPI_Comm comm, std::span<const GlobalIndex> ids, Index n_owned,
                                  const std::vector<int>& ghost_owner) {
  std::vector<std::pair<GlobalIndex, Index>> owned(n_owned);
  for (Index i = 0; i < n_owned; ++i) owned[i] = {ids[i], i};
  std::sort(owned.begin(), owned.end());

  std::vector<std::vector<GlobalIndex>> wanted(parallel::comm_size(comm));
  for (std::size_t g = 0; g < ghost_owner.size(); ++g) wanted[ghost_owner[g]].push_back(ids[n_owned + g]);
  std::vector<std::vector<Index>> answers(parallel::comm_size(comm));
  const auto asked = parallel::all_to_all(comm, wanted);
  for (std::size_t r = 0; r < asked.size(); ++r)
    for (const GlobalIndex id : asked[r])
      answers[r].push_back(std::lower_bound(owned.begin(), owned.end(), std::pair(id, Index(0)))->second);
  const auto told = parallel::all_to_all(comm, answers);
  std::vector<Index> remote, next(told.size(), 0);
  for (const int r : ghost_owner) remote.push_back(told[r][next[r]++]);
  return parallel::IndexMap(comm, n_owned, ghost_owner, remote);
}

}  // namespace couplet::mesh
