// SPDX-License-Identifier: Apache-2.0
#include "common/fv/point_gradient.hpp"

#include <Eigen/Geometry>

namespace couplet::fv {
namespace {

/// A place with the field's value and gradient.
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

/// Value that lies `part` L . (G_b - G_a) below the trapezoid: 1/8 in the middle of an edge, 1/12 as its
/// mean.
Vec3 below_chord(const Knot& a, const Knot& b, double part) {
  return 0.5 * (a.u + b.u) - part * (b.slope - a.slope).transpose() * (b.x - a.x);
}

/// Integrals over a face with its normal: of the values, S u^T, and of the place, S . x with x from `origin`.
struct Flux {
  Tensor3 values = Tensor3::Zero();
  Vec3 area = Vec3::Zero();
  double volume = 0;  ///< dim times that of the cone from `origin`

  void add(const Vec3& part, const Vec3& u, const Vec3& x) {
    values += part * u.transpose();
    area += part;
    volume += part.dot(x);
  }
};

/// The mean of the corners as a knot: u(x) = u_i + (x - x_i) . (G_i + G) / 2 holds for a quadratic from each
/// corner, and (x - x_i) . G cancels in their mean.
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

/// The mean of a quadratic over a triangle is that of the middles of its edges.
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
  // The volume between these triangles, not the mesh's: what makes linear fields exact on warped faces.
  for (Index c = 0; c < n_owned; ++c) gradient[c] /= volume[c];
  return gradient;
}

}  // namespace couplet::fv
