// SPDX-License-Identifier: Apache-2.0
#include "common/fv/gradients.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace couplet::fv {

FaceGradient::FaceGradient(const mesh::Mesh& mesh, const mesh::Geometry& geometry)
    : normal(mesh.n_faces()),
      inverse_dn(mesh.n_faces()),
      skew(mesh.n_faces()),
      tangential(mesh.face_points.index.size()) {
  update(mesh, geometry);
}

void FaceGradient::update(const mesh::Mesh& mesh, const mesh::Geometry& geometry) {
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const FaceLine line = face_line(mesh, geometry, f);
    normal[f] = line.normal;
    inverse_dn[f] = line.inverse_dn;
    skew[f] = line.skew;
    tangential_weights(mesh, geometry.points, f, line, tangential.data() + mesh.face_points.offset[f]);
  }
}

FaceLine face_line(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  FaceLine line;
  line.area = geometry.face_area[f].norm();
  line.normal = geometry.face_area[f] / line.area;
  const Vec3 across = f < mesh.n_interior ? Vec3(geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f))
                                          : geometry.face_centre[f];
  const Vec3 d = across - geometry.cell_centre[mesh.owner[f]];
  line.inverse_dn = 1 / d.dot(line.normal);
  line.skew = line.normal - d * line.inverse_dn;
  return line;
}

void tangential_weights(const mesh::Mesh& mesh, std::span<const Vec3> points, Index f, const FaceLine& line,
                        Vec3* c) {
  const auto index = mesh.face_points[f];
  if (mesh.dim == 2) {
    // Derivative along an edge a-b of unit depth.
    c[1] = (points[index[1]] - points[index[0]]) / (line.area * line.area);
    c[0] = -c[1];
    return;
  }
  // L_e m_e = (x_2 - x_1) x n, half of it for each end point (2.56).
  for (std::size_t i = 0; i < index.size(); ++i) c[i].setZero();
  for (std::size_t i = 0; i < index.size(); ++i) {
    const std::size_t j = (i + 1) % index.size();
    const Vec3 half = (points[index[j]] - points[index[i]]).cross(line.normal) / (2 * line.area);
    c[i] += half;
    c[j] += half;
  }
}

}  // namespace couplet::fv
