// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/axisymmetric_faces.hpp"

#include <numbers>

namespace couplet::elastic {
namespace {

double cross(const Vec3& a, const Vec3& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Twice the signed area.
double twice_area(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }

}  // namespace

double circumference(double radius) { return 2 * std::numbers::pi * radius; }

AxisymmetricFace axisymmetric_face(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const mesh::Geometry& geometry = rows.geometry();
  const auto points = mesh.face_points[f];
  AxisymmetricFace face{};
  face.point = {points[0], points[1]};
  face.has_shear = !rows.mirrored(f);
  // Around the quadrilateral: owner, first point, node across, second point, as places of the arrays.
  const std::array<std::size_t, 4> around{0, 2, 1, 3};
  std::array<Vec3, 4> x;
  x[0] = geometry.cell_centre[mesh.owner[f]];
  x[1] = f < mesh.n_interior ? Vec3(geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f))
                             : geometry.face_centre[f];
  x[2] = geometry.points[points[0]], x[3] = geometry.points[points[1]];
  const double here = twice_area(x[0], x[2], x[1]), there = twice_area(x[0], x[1], x[3]),
               whole = here + there, turn = whole > 0 ? 1 : -1;
  const double area = 0.5 * std::abs(whole);
  std::array<double, 4> mean{};  // weights of the value at the centroid
  if (face.has_shear)
    mean = {1. / 3, 1. / 3, here / (3 * whole), there / (3 * whole)};
  else
    mean = {1. / 3, 0, 1. / 3, 1. / 3};
  double radius = 0;
  for (std::size_t i = 0; i < 4; ++i) radius += mean[i] * x[i][0];
  const double scale = 1 / (radius * area);
  const auto add_side = [&](std::size_t i, std::size_t j) {
    const Vec3 side = turn * (x[j] - x[i]);
    const double n[2] = {side[1], -side[0]};
    for (std::size_t a = 0; a < 2; ++a) {
      face.b[i][a] += scale * n[a] * (2 * x[i][0] + x[j][0]) / 6;
      face.b[j][a] += scale * n[a] * (x[i][0] + 2 * x[j][0]) / 6;
    }
  };
  if (face.has_shear) {
    for (std::size_t k = 0; k < 4; ++k) add_side(around[k], around[(k + 1) % 4]);
  } else {
    add_side(0, 2), add_side(2, 3), add_side(3, 0);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    face.hoop[i] = mean[i] / radius;
    face.b[i][0] -= face.hoop[i];
  }
  face.volume = circumference(radius) * area;
  return face;
}

}  // namespace couplet::elastic
