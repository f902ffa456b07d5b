// SPDX-License-Identifier: Apache-2.0
#include "common/fv/face_gradient.hpp"

#include <Eigen/Geometry>

namespace couplet {

FaceGradient::FaceGradient(const Mesh& mesh)
    : normal(mesh.n_faces()),
      inverse_dn(mesh.n_faces()),
      skew(mesh.n_faces()),
      tangential(mesh.face_points.index.size()) {
  update(mesh, mesh.reference, mesh.reference_points);
}

void FaceGradient::update(const Mesh& mesh, const Geometry& geometry, std::span<const Vec3> points) {
  const auto& offset = mesh.face_points.offset;
  const auto& index = mesh.face_points.index;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const double area = geometry.face_area[f].norm();
    const Vec3 n = geometry.face_area[f] / area;
    const Vec3 across = f < mesh.n_interior ? Vec3(geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f))
                                            : geometry.face_centre[f];
    const Vec3 d = across - geometry.cell_centre[mesh.owner[f]];
    normal[f] = n;
    inverse_dn[f] = 1 / d.dot(n);
    skew[f] = n - d * inverse_dn[f];
    const Index first = offset[f], count = offset[f + 1] - first;
    if (mesh.dim == 2) {
      // An edge a-b of unit depth: the derivative along it.
      const Vec3 along = points[index[first + 1]] - points[index[first]];
      tangential[first + 1] = along / (area * area);
      tangential[first] = -tangential[first + 1];
      continue;
    }
    // L_e m_e = (x_2 - x_1) x n, half of it to each end point (2.56).
    for (Index i = 0; i < count; ++i) tangential[first + i].setZero();
    for (Index i = 0; i < count; ++i) {
      const Index j = (i + 1) % count;
      const Vec3 edge = points[index[first + j]] - points[index[first + i]];
      const Vec3 half = edge.cross(n) / (2 * area);
      tangential[first + i] += half;
      tangential[first + j] += half;
    }
  }
}

}  // namespace couplet
