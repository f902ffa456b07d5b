// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_faces.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace couplet::elastic {
namespace {

/// From the owner to the node across; the mirror image of the owner at a symmetry plane.
Vec3 line_across(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f, bool mirrored) {
  const Vec3& here = geometry.cell_centre[mesh.owner[f]];
  if (f < mesh.n_interior) return geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f) - here;
  if (!mirrored) return geometry.face_centre[f] - here;
  const Vec3 n = geometry.face_area[f].normalized();
  return 2 * n.dot(geometry.face_centre[f] - here) * n;
}

}  // namespace

template <int D>
SymmetricFace<D> symmetric_face(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const mesh::Geometry& geometry = rows.geometry();
  const bool mirrored = rows.mirrored(f);
  const Vec3 d = line_across(mesh, geometry, f, mirrored);
  const auto point = mesh.face_points[f];
  const bool diagonals = point.size() == 4;
  SymmetricFace<D> face;
  std::array<Vec3, 2> side{Vec3::Zero(), Vec3::Zero()};
  for (int i = 0; i < D - 1; ++i) {
    face.plus[i] = point[diagonals ? i : i + 1];
    face.minus[i] = point[diagonals ? i + 2 : 0];
    side[i] = geometry.points[face.plus[i]] - geometry.points[face.minus[i]];
  }
  Vec3 area, c[2];
  if constexpr (D == 3) {
    area = 0.5 * side[0].cross(side[1]);
    c[0] = 0.5 * side[1].cross(d);
    c[1] = 0.5 * d.cross(side[0]);
  } else {
    const Vec3& e = side[0];
    const double turn = geometry.face_area[f].dot(Vec3(e[1], -e[0], 0)) > 0 ? 1 : -1;
    area = turn * Vec3(e[1], -e[0], 0);
    c[0] = turn * Vec3(-d[1], d[0], 0);
  }
  const double whole = area.dot(d);
  face.inverse = 1 / whole;
  face.volume = whole / D * (mirrored ? 0.5 : 1);
  for (int a = 0; a < D; ++a) {
    face.area[a] = area[a];
    for (int i = 0; i < D - 1; ++i) face.across[i][a] = c[i][a];
  }
  return face;
}

template SymmetricFace<2> symmetric_face<2>(const mesh::Mesh&, const ElasticOperator&, Index);
template SymmetricFace<3> symmetric_face<3>(const mesh::Mesh&, const ElasticOperator&, Index);

std::array<double, 4> point_shares(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  std::array<double, 4> shares{};
  const auto point = mesh.face_points[f];
  if (mesh.dim == 2) return {0.5, 0.5};
  double whole = 0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const std::size_t j = (i + 1) % point.size();
    const Vec3& centre = geometry.face_centre[f];
    const double area = (geometry.points[point[i]] - centre).cross(geometry.points[point[j]] - centre).norm();
    whole += area;
    shares[i] += 0.5 * area;
    shares[j] += 0.5 * area;
  }
  for (double& s : shares) s /= whole;
  return shares;
}

std::array<double, 2> pyramids(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  const Vec3& s = geometry.face_area[f];
  const double here = s.dot(geometry.face_centre[f] - geometry.cell_centre[mesh.owner[f]]) / mesh.dim;
  if (f >= mesh.n_interior) return {here, 0};
  const Vec3 there = geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f);
  return {here, s.dot(there - geometry.face_centre[f]) / mesh.dim};
}

}  // namespace couplet::elastic
