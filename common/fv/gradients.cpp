// SPDX-License-Identifier: Apache-2.0
#include "common/fv/gradients.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <cstring>

#include "common/base/processor_clones.hpp"

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

namespace {

/// Position with value and gradient of the field.
struct Knot {
  Vec3 x = Vec3::Zero(), u = Vec3::Zero();
  Tensor3 slope = Tensor3::Zero();
};

Knot knot_at(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index point,
             std::span<const double> values, std::span<const Tensor3> slopes) {
  Knot knot{geometry.points[point], Vec3::Zero(), slopes[point]};
  for (int a = 0; a < mesh.dim; ++a) knot.u[a] = values[std::size_t(point) * mesh.dim + a];
  return knot;
}

/// Value `part` L . (G_b - G_a) below the trapezoidal one: 1/8 in the middle of an edge, 1/12 for its mean.
Vec3 below_chord(const Knot& a, const Knot& b, double part) {
  return 0.5 * (a.u + b.u) - part * (b.slope - a.slope).transpose() * (b.x - a.x);
}

/// Integrals over a face with its normal: S u^T of the values, and S . x of the position relative to
/// `origin`.
struct Flux {
  Tensor3 values = Tensor3::Zero();
  Vec3 area = Vec3::Zero();
  double volume = 0;  ///< dim times the volume of the cone from `origin`

  void add(const Vec3& part, const Vec3& u, const Vec3& x) {
    values += part * u.transpose();
    area += part;
    volume += part.dot(x);
  }
};

/// Value and gradient at the mean of the corners. For a quadratic, u(x) = u_i + (x - x_i) . (G_i + G) / 2
/// from each corner, and (x - x_i) . G cancels in the mean.
Knot middle_of(std::span<const Knot> corners) {
  const auto n = double(corners.size());
  Knot middle;
  for (const Knot& corner : corners) {
    middle.x += corner.x / n;
    middle.slope += corner.slope / n;
  }
  for (const Knot& corner : corners)
    middle.u += (corner.u + 0.5 * corner.slope.transpose() * (middle.x - corner.x)) / n;
  return middle;
}

/// Adds a triangle. The mean of a quadratic is that of its edge midpoints.
void add_triangle(const Knot& a, const Knot& b, const Knot& c, const Vec3& origin, Flux& flux) {
  const Vec3 to_b = b.x - a.x, to_c = c.x - a.x;
  const Vec3 u = (below_chord(a, b, 1.0 / 8) + below_chord(b, c, 1.0 / 8) + below_chord(c, a, 1.0 / 8)) / 3;
  flux.add(0.5 * to_b.cross(to_c), u, (a.x + b.x + c.x) / 3 - origin);
}

Flux flux_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index face, const Vec3& origin,
             std::span<const double> values, std::span<const Tensor3> slopes) {
  const auto points = mesh.face_points[face];
  const std::size_t n = points.size();
  std::array<Knot, 4> knots;
  for (std::size_t i = 0; i < n; ++i) knots[i] = knot_at(mesh, geometry, points[i], values, slopes);
  Flux flux;
  if (mesh.dim == 2) {
    flux.add(geometry.face_area[face], below_chord(knots[0], knots[1], 1.0 / 12),
             0.5 * (knots[0].x + knots[1].x) - origin);
  } else if (n == 3) {
    add_triangle(knots[0], knots[1], knots[2], origin, flux);
  } else {
    const Knot middle = middle_of({knots.data(), n});
    for (std::size_t i = 0; i < n; ++i) add_triangle(middle, knots[i], knots[(i + 1) % n], origin, flux);
  }
  return flux;
}

}  // namespace

std::vector<Tensor3> gradients_from_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           std::span<const double> values, std::span<const Tensor3> slopes) {
  const Index n_owned = mesh.cells.n_owned();
  std::vector<Tensor3> gradient(n_owned, Tensor3::Zero());
  std::vector<double> volume(n_owned, 0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index owner = mesh.owner[f];
    const Vec3& centre = geometry.cell_centre[owner];
    const Flux flux = flux_of(mesh, geometry, f, centre, values, slopes);
    if (owner < n_owned) {
      gradient[owner] += flux.values;
      volume[owner] += flux.volume / mesh.dim;
    }
    if (f >= mesh.n_interior || mesh.neighbour[f] >= n_owned) continue;
    const Index other = mesh.neighbour[f];
    const Vec3 step = geometry.cell_centre[other] + mesh.shift(f) - centre;
    gradient[other] -= flux.values;
    volume[other] -= (flux.volume - flux.area.dot(step)) / mesh.dim;
  }
  // The volume between these triangles makes linear fields exact on warped faces; that of the mesh would not.
  for (Index c = 0; c < n_owned; ++c) gradient[c] /= volume[c];
  return gradient;
}

}  // namespace couplet::fv
