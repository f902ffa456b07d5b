// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/surface_mesh.hpp"

#include <utility>

#include "common/io/fields/part_points.hpp"

namespace couplet::io {

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
