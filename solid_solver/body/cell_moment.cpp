// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/cell_moment.hpp"

#include "common/mesh/topology.hpp"

namespace couplet::solid {
namespace {

/// Of the mean over the vertices, in that over the volume: exact for simplices and boxes.
double share_of_vertices(mesh::CellType type) {
  switch (type) {
    case mesh::CellType::triangle:
      return 1. / 4;
    case mesh::CellType::tetrahedron:
      return 1. / 5;
    case mesh::CellType::prism:
    case mesh::CellType::pyramid:
      return 7. / 24;
    default:
      return 1. / 3;
  }
}

}  // namespace

Tensor3 cell_moment(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index cell) {
  Tensor3 moment = Tensor3::Zero();
  for (const Index v : mesh.cell_points[cell]) {
    const Vec3 arm = geometry.points[v] - geometry.cell_centre[cell];
    moment += arm * arm.transpose();
  }
  return moment * (share_of_vertices(mesh.cell_type[cell]) / double(mesh.cell_points[cell].size()));
}

void gather_cells(const mesh::Mesh& mesh, const mesh::Csr& cells_of_point, Index cell,
                  std::vector<Index>& mark, std::vector<Index>& cells) {
  for (const Index v : mesh.cell_points[cell])
    for (const Index c : cells_of_point[v]) {
      if (mark[std::size_t(c)] == cell || mesh.material_of(c) != mesh.material_of(cell)) continue;
      mark[std::size_t(c)] = cell;
      cells.push_back(c);
    }
}

mesh::Csr boundary_faces_of_cells(const mesh::Mesh& mesh) {
  mesh::Csr owners;
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) owners.push_row({&mesh.owner[f], 1});
  mesh::Csr faces = mesh::transpose(owners, 0, mesh.cells.n_local());
  for (Index& f : faces.index) f += mesh.n_interior;
  return faces;
}

}  // namespace couplet::solid
