// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/entries.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {
namespace {

constexpr GlobalIndex most_faces = 8;  // more than the faces of any cell

/// Position of an interior face among the owner's faces, in the order of the cell's shape.
GlobalIndex place_at_owner(const Mesh& mesh, Index face) {
  const Index cell = mesh.owner[face];
  const CellShape& shape = shape_of(mesh.cell_type[cell]);
  const auto points = mesh.cell_points[cell];
  const auto corners = mesh.face_points[face];
  for (int k = 0; k < shape.n_faces; ++k) {
    const int n = shape.face_size(k);
    if (n != std::ssize(corners)) continue;
    const bool same = std::all_of(shape.faces[k].begin(), shape.faces[k].begin() + n, [&](std::int8_t at) {
      return std::ranges::find(corners, points[at]) != corners.end();
    });
    if (same) return k;
  }
  throw Error("A face of the mesh has points that the cell that owns it does not have.");
}

/// Order of interior faces, optionally followed by boundary faces.
parallel::GlobalOrder order_of_faces(const Mesh& mesh, bool with_boundary) {
  std::vector<GlobalIndex> ids;
  std::vector<char> owned;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    ids.push_back(mesh.cell_id[mesh.owner[f]] * most_faces + place_at_owner(mesh, f));
    owned.push_back(mesh.owner[f] < mesh.cells.n_owned());
  }
  if (with_boundary) {
    GlobalIndex after = 0;
    for (const GlobalIndex id : mesh.cell_id) after = std::max(after, (id + 1) * most_faces);
    MPI_Allreduce(MPI_IN_PLACE, &after, 1, MPI_INT64_T, MPI_MAX, mesh.comm);
    for (Index b = 0; b < mesh.boundary.n_owned(); ++b) {
      ids.push_back(after + mesh.boundary_id[b]);
      owned.push_back(1);
    }
  }
  return {mesh.comm, ids, owned};
}

parallel::GlobalOrder order_of(const Mesh& mesh, Entries entries) {
  const auto owned_of = [&](const std::vector<GlobalIndex>& ids, const parallel::IndexMap& map) {
    return parallel::GlobalOrder(mesh.comm, {ids.data(), std::size_t(map.n_owned())},
                                 std::size_t(map.n_owned()));
  };
  const auto all_of = [&](const std::vector<GlobalIndex>& ids, const parallel::IndexMap& map) {
    return parallel::GlobalOrder(mesh.comm, ids, std::size_t(map.n_owned()));
  };
  switch (entries) {
    case Entries::cells:
      return all_of(mesh.cell_id, mesh.cells);
    case Entries::owned_cells:
      return owned_of(mesh.cell_id, mesh.cells);
    case Entries::points:
      return all_of(mesh.point_id, mesh.points);
    case Entries::boundary:
      return all_of(mesh.boundary_id, mesh.boundary);
    case Entries::owned_boundary:
      return owned_of(mesh.boundary_id, mesh.boundary);
    case Entries::interior_faces:
      return order_of_faces(mesh, false);
    case Entries::flux_faces:
      return order_of_faces(mesh, true);
  }
  throw Error("Unknown kind of entries of a mesh.");
}

std::uint64_t mixed(std::uint64_t hash, GlobalIndex value) {
  hash = (hash ^ static_cast<std::uint64_t>(value)) * 1099511628211ull;
  return hash ^ (hash >> 29);
}

constexpr std::uint64_t start_of_digest = 14695981039346656037ull;

}  // namespace

const parallel::GlobalOrder& OrderOfEntries::of(Entries entries) {
  auto& order = orders_[static_cast<std::size_t>(entries)];
  if (!order) order = order_of(*mesh_, entries);
  return *order;
}

/// The digest is a sum over owned cells and boundary faces, which does not depend on the partition.
std::array<std::int64_t, 4> identity_of(const Mesh& mesh) {
  std::uint64_t digest = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    std::uint64_t cell = mixed(start_of_digest, mesh.cell_id[c]);
    for (const Index point : mesh.cell_points[c]) cell = mixed(cell, mesh.point_id[point]);
    digest += cell;
  }
  const std::vector<Index> patch = mesh.patch_of_boundary();
  for (Index b = 0; b < mesh.boundary.n_owned(); ++b)
    digest += mixed(mixed(mixed(start_of_digest, mesh.boundary_id[b]), patch[b]),
                    mesh.cell_id[mesh.owner[mesh.n_interior + b]]);
  MPI_Allreduce(MPI_IN_PLACE, &digest, 1, MPI_UINT64_T, MPI_SUM, mesh.comm);
  return {mesh.cells.n_global(), mesh.points.n_global(), mesh.boundary.n_global(),
          static_cast<std::int64_t>(digest)};
}

std::uint64_t share_of_rank(const Mesh& mesh) {
  std::uint64_t hash = start_of_digest;
  for (const auto* ids : {&mesh.cell_id, &mesh.point_id, &mesh.boundary_id})
    for (const GlobalIndex id : *ids) hash = mixed(hash, id);
  return hash;
}

}  // namespace couplet::mesh
