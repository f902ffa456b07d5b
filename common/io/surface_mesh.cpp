// SPDX-License-Identifier: Apache-2.0
#include "common/io/surface_mesh.hpp"

#include "common/parallel/collective.hpp"

namespace couplet::io {
namespace {

constexpr Index unused = -1;

/// Numbers of the surface's points by local point of the body, owned ones first: also those that only faces of other ranks
/// use. Collective.
std::vector<Index> number_points(const mesh::Mesh& body, const mesh::Patch& patch,
                                 std::vector<Index>& points) {
  std::vector<double> uses(body.points.n_local(), 0);
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index v : body.face_points[f]) uses[v] = 1;
  body.points.add_to_owners(uses);
  std::vector<Index> number(uses.size(), unused);
  for (std::size_t v = 0; v < uses.size(); ++v) {
    if (uses[v] == 0) continue;
    number[v] = static_cast<Index>(points.size());
    points.push_back(static_cast<Index>(v));
  }
  return number;
}

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

}  // namespace

SurfaceMesh make_surface(const mesh::Mesh& body, std::span<const Vec3> places, const mesh::Patch& patch) {
  SurfaceMesh surface;
  mesh::Mesh& mesh = surface.mesh;
  mesh.comm = body.comm;
  mesh.dim = body.dim - 1;
  const std::vector<Index> number = number_points(body, patch, surface.points);
  mesh.points = map_points(body, surface.points, number);
  mesh.cells = parallel::IndexMap(body.comm, patch.count, {}, {});
  for (const Index v : surface.points) {
    mesh.point_id.push_back(body.point_id[v]);
    surface.places.push_back(places[v]);
  }
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
