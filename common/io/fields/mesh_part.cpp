// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/mesh_part.hpp"

#include <numeric>
#include <utility>

#include "common/parallel/collective.hpp"

namespace couplet::io {

namespace {

constexpr Index unused = -1;

/// Numbers the points of a part over all ranks. Collective.
parallel::IndexMap map_points(const mesh::Mesh& body, std::span<const Index> points,
                              std::span<const Index> number) {
  std::vector<GlobalIndex> there(number.begin(), number.end());
  body.points.update_ghosts(there);
  std::vector<GlobalIndex> rank(number.size(), parallel::comm_rank(body.comm));
  body.points.update_ghosts(rank);
  std::vector<int> owner;
  std::vector<Index> remote;
  for (const Index v : points) {
    if (v < body.points.n_owned()) continue;
    owner.push_back(static_cast<int>(rank[v]));
    remote.push_back(static_cast<Index>(there[v]));
  }
  return {body.comm, static_cast<Index>(points.size() - owner.size()), owner, remote};
}

/// Makes a part of `entries`, whose points are given by `points_of`, without types and ids. Collective.
template <class PointsOf>
MeshPart part_of(const mesh::Mesh& body, std::span<const Vec3> places, std::vector<Index> entries,
                 const PointsOf& points_of) {
  MeshPart part;
  part.entries = std::move(entries);
  part.mesh.comm = body.comm;
  part.mesh.cells = parallel::IndexMap(body.comm, static_cast<Index>(part.entries.size()), {}, {});
  std::vector<double> uses(body.points.n_local(), 0);
  for (const Index e : part.entries)
    for (const Index v : points_of(e)) uses[v] = 1;
  body.points.add_to_owners(uses);  // includes points used only by other ranks
  std::vector<Index> number(uses.size(), unused);
  for (std::size_t v = 0; v < uses.size(); ++v) {
    if (uses[v] == 0) continue;
    number[v] = static_cast<Index>(part.points.size());
    part.points.push_back(static_cast<Index>(v));
    part.mesh.point_id.push_back(body.point_id[v]);
    part.places.push_back(places[v]);
  }
  part.mesh.points = map_points(body, part.points, number);
  std::vector<Index> corners;
  for (const Index e : part.entries) {
    corners.clear();
    for (const Index v : points_of(e)) corners.push_back(number[v]);
    part.mesh.cell_points.push_row(corners);
  }
  return part;
}

}  // namespace

MeshPart make_part(const mesh::Mesh& body, std::span<const Vec3> places,
                   const std::vector<std::uint8_t>& flags) {
  std::vector<Index> cells;
  for (Index c = 0; c < body.cells.n_owned(); ++c)
    if (flags[c]) cells.push_back(c);
  MeshPart part = part_of(body, places, std::move(cells), [&](Index c) { return body.cell_points[c]; });
  part.mesh.dim = body.dim;
  for (const Index c : part.entries) {
    part.mesh.cell_type.push_back(body.cell_type[c]);
    part.mesh.cell_id.push_back(body.cell_id[c]);
  }
  return part;
}

MeshPart make_surface(const mesh::Mesh& body, std::span<const Vec3> places, const mesh::Patch& patch) {
  std::vector<Index> faces(std::size_t(patch.count));
  std::iota(faces.begin(), faces.end(), patch.first);
  MeshPart surface = part_of(body, places, std::move(faces), [&](Index f) { return body.face_points[f]; });
  surface.mesh.dim = body.dim - 1;
  for (const Index f : surface.entries) {
    // An edge has no type of its own; FieldWriter recognizes it by its two points.
    surface.mesh.cell_type.push_back(body.face_points[f].size() == 4 ? mesh::CellType::quadrilateral
                                                                     : mesh::CellType::triangle);
    surface.mesh.cell_id.push_back(body.boundary_id[f - body.n_interior]);
  }
  return surface;
}

std::vector<std::uint8_t> cells_within(const mesh::Mesh& mesh, std::span<const Vec3> places,
                                       const FieldChoice::Box& box) {
  std::vector<std::uint8_t> flags(mesh.cells.n_owned(), 0);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    Vec3 mean = Vec3::Zero();
    for (const Index v : mesh.cell_points[c]) mean += places[v];
    mean /= double(mesh.cell_points[c].size());
    bool within = true;
    for (int d = 0; d < mesh.dim; ++d) within = within && mean[d] >= box.from[d] && mean[d] <= box.to[d];
    flags[c] = within;
  }
  return flags;
}

OutputField picked(const OutputField& field, std::span<const Index> entries, std::vector<double>& values) {
  const std::size_t n = field.components;
  values.clear();
  for (const Index i : entries) {
    const auto one = field.values.subspan(std::size_t(i) * n, n);
    values.insert(values.end(), one.begin(), one.end());
  }
  OutputField here = field;
  here.values = values;
  return here;
}

}  // namespace couplet::io
