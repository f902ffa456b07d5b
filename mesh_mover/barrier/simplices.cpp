// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/barrier/simplices.hpp"

#include <Eigen/LU>
#include <cmath>
#include <span>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "mesh_mover/cell_corners.hpp"

namespace couplet::mesh_mover {
namespace {

/// The simplices of a kind of cell, by corners of the cell.
std::span<const CellCorner> simplices_of(mesh::CellType type) {
  const std::vector<CellCorner>& corners = corners_of(type).corners;
  const bool is_simplex = type == mesh::CellType::triangle || type == mesh::CellType::tetrahedron;
  return {corners.data(), is_simplex ? 1 : corners.size()};
}

template <int D>
void append(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index cell, double stiffness,
            Simplices& s) {
  using Matrix = Eigen::Matrix<double, D, D>;
  const auto corner = mesh.cell_points[cell];
  const auto all = simplices_of(mesh.cell_type[cell]);
  double sum = 0;
  const std::size_t first = s.weight.size();
  for (const CellCorner& k : all) {
    Matrix edges;
    for (int i = 0; i < D; ++i)
      edges.col(i) = (geometry.points[corner[k[i + 1]]] - geometry.points[corner[k[0]]]).template head<D>();
    const double det = edges.determinant();
    if (!(det > 0)) {
      const Vec3& x = geometry.cell_centre[cell];
      throw SolveFailure(
          "method: barrier requires cells whose corners are all convex; cell {} at ({:.4g}, {:.4g}, {:.4g}) m has a "
          "flat or re-entrant corner.",
          mesh.cell_id[cell], x.x(), x.y(), x.z());
    }
    const Matrix inverse = edges.inverse();
    s.inverse.insert(s.inverse.end(), inverse.data(), inverse.data() + D * D);
    for (int i = 0; i <= D; ++i) s.points.push_back(corner[k[i]]);
    s.cell.push_back(cell);
    s.weight.push_back(det);
    sum += det;
  }
  for (std::size_t i = first; i < s.weight.size(); ++i)
    s.weight[i] *= stiffness * geometry.volume[cell] / sum;
}

}  // namespace

Simplices make_simplices(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double stiffening,
                         const std::vector<double>& volumes) {
  Simplices s;
  s.dim = mesh.dim;
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += volumes[c];
  const double mean = parallel::sum(mesh.comm, volume) / static_cast<double>(mesh.cells.n_global());
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const double stiffness = std::pow(volumes[c] / mean, -stiffening);
    mesh.dim == 2 ? append<2>(mesh, geometry, c, stiffness, s) : append<3>(mesh, geometry, c, stiffness, s);
    if (c + 1 == mesh.cells.n_owned()) s.n_owned = s.size();
  }
  double total = 0;
  for (Index i = 0; i < s.n_owned; ++i) total += s.weight[i];
  s.total = parallel::sum(mesh.comm, total);
  return s;
}

}  // namespace couplet::mesh_mover
