// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/mesh_part.hpp"

#include <utility>

#include "common/parallel/collective.hpp"

namespace couplet::io {

namespace {

constexpr Index unused = -1;

/// Collective.
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

/// Numbers of a part's points by local point of the body (-1: not of the part), owned ones first: also those that only other ranks
/// use. `uses`: 1 for those that are used here. `points` becomes the local points of the body. Collective.
std::vector<Index> number_points(const mesh::Mesh& body, std::vector<double> uses,
                                 std::vector<Index>& points) {
  body.points.add_to_owners(uses);
  std::vector<Index> number(uses.size(), unused);
  for (std::size_t v = 0; v < uses.size(); ++v) {
    if (uses[v] == 0) continue;
    number[v] = static_cast<Index>(points.size());
    points.push_back(static_cast<Index>(v));
  }
  return number;
}

/// Their map, ids and places [m]. Collective.
void set_points(mesh::Mesh& part, std::vector<Vec3>& there, const mesh::Mesh& body,
                std::span<const Vec3> places, std::span<const Index> points, std::span<const Index> number) {
  part.comm = body.comm;
  part.points = map_points(body, points, number);
  for (const Index v : points) {
    part.point_id.push_back(body.point_id[v]);
    there.push_back(places[v]);
  }
}

}  // namespace

CellPart make_part(const mesh::Mesh& body, std::span<const Vec3> places,
                   const std::vector<std::uint8_t>& flags) {
  CellPart part;
  mesh::Mesh& mesh = part.mesh;
  mesh.dim = body.dim;
  std::vector<double> uses(body.points.n_local(), 0);
  for (Index c = 0; c < body.cells.n_owned(); ++c) {
    if (!flags[c]) continue;
    part.cells.push_back(c);
    for (const Index v : body.cell_points[c]) uses[v] = 1;
  }
  const std::vector<Index> number = number_points(body, std::move(uses), part.points);
  set_points(mesh, part.places, body, places, part.points, number);
  mesh.cells = parallel::IndexMap(body.comm, static_cast<Index>(part.cells.size()), {}, {});
  std::vector<Index> corners;
  for (const Index c : part.cells) {
    corners.clear();
    for (const Index v : body.cell_points[c]) corners.push_back(number[v]);
    mesh.cell_points.push_row(corners);
    mesh.cell_type.push_back(body.cell_type[c]);
    mesh.cell_id.push_back(body.cell_id[c]);
  }
  return part;
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

OutputField part_of(const OutputField& field, const CellPart& part, std::vector<double>& values) {
  const std::size_t n = field.components;
  values.clear();
  for (const Index i : field.place == OutputField::Place::cells ? part.cells : part.points) {
    const auto one = field.values.subspan(std::size_t(i) * n, n);
    values.insert(values.end(), one.begin(), one.end());
  }
  OutputField here = field;
  here.values = values;
  return here;
}

SurfaceMesh make_surface(const mesh::Mesh& body, std::span<const Vec3> places, const mesh::Patch& patch) {
  SurfaceMesh surface;
  mesh::Mesh& mesh = surface.mesh;
  mesh.dim = body.dim - 1;
  std::vector<double> uses(body.points.n_local(), 0);
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index v : body.face_points[f]) uses[v] = 1;
  const std::vector<Index> number = number_points(body, std::move(uses), surface.points);
  set_points(mesh, surface.places, body, places, surface.points, number);
  mesh.cells = parallel::IndexMap(body.comm, patch.count, {}, {});
  std::vector<Index> corners;
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    corners.clear();
    for (const Index v : body.face_points[f]) corners.push_back(number[v]);
    mesh.cell_points.push_row(corners);
    // An edge has no type of its own: FieldWriter knows it by its two points.
    mesh.cell_type.push_back(corners.size() == 4 ? mesh::CellType::quadrilateral : mesh::CellType::triangle);
    mesh.cell_id.push_back(body.boundary_id[f - body.n_interior]);
  }
  return surface;
}

}  // namespace couplet::io
