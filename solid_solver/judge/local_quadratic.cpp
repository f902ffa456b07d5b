// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/judge/local_quadratic.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/elasticity/vector_at.hpp"

namespace couplet::solid {
namespace {

constexpr double near_weight = 0.05;  // beside the square of the distance over the patch's reach
constexpr double least = 1e-9;        // of a term that no sample determines, over one that they do
constexpr double round_off =
    1e-20;  // of the squares of a term in the samples: a direction that they do not span

struct MirrorPlane {
  Vec3 normal, origin;
  Vec3 reflect(const Vec3& v) const { return v - 2 * normal.dot(v) * normal; }
  Vec3 image(const Vec3& place) const { return place - 2 * normal.dot(place - origin) * normal; }
};

struct Neighbours {
  std::vector<Index> cells, faces;
  std::vector<MirrorPlane> mirrors;
  double reach = 0;
};

Neighbours around(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index cell) {
  const mesh::Geometry& g = rows.geometry();
  Neighbours found;
  std::vector<bool> is_near(std::size_t(mesh.cells.n_local()), false);
  const auto own = mesh.cell_points[cell];
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const auto points = mesh.cell_points[c];
    const auto touches = [&](Index v) { return std::ranges::find(own, v) != own.end(); };
    if (mesh.material_of(c) != mesh.material_of(cell) || std::ranges::none_of(points, touches)) continue;
    is_near[std::size_t(c)] = true;
    found.cells.push_back(c);
    found.reach = std::max(found.reach, (g.cell_centre[c] - g.cell_centre[cell]).norm());
  }
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) {
    if (!is_near[std::size_t(mesh.owner[f])]) continue;
    if (!rows.mirrored(f)) {
      found.faces.push_back(f);
      continue;
    }
    const MirrorPlane plane{g.face_area[f].normalized(), g.face_centre[f]};
    const auto is_same = [&](const MirrorPlane& m) { return m.normal.dot(plane.normal) > 0.99; };
    if (std::ranges::none_of(found.mirrors, is_same)) found.mirrors.push_back(plane);
  }
  if (found.reach == 0) found.reach = std::pow(g.volume[cell], 1. / mesh.dim);
  return found;
}

Eigen::VectorXd terms(const Vec3& d, int dim) {
  Eigen::VectorXd phi(1 + dim + dim * (dim + 1) / 2);
  int i = 0;
  phi[i++] = 1;
  for (int a = 0; a < dim; ++a) phi[i++] = d[a];
  for (int a = 0; a < dim; ++a)
    for (int b = a; b < dim; ++b) phi[i++] = d[a] * d[b];
  return phi;
}

}  // namespace

Vec3 quadratic_displacement(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index cell,
                            const Vec3& place, std::span<const double> cell_u,
                            std::span<const double> face_u) {
  const mesh::Geometry& g = rows.geometry();
  const int dim = mesh.dim;
  const Neighbours patch = around(mesh, rows, cell);
  const Vec3 centre = g.cell_centre[cell];
  const Eigen::VectorXd at_place = terms((place - centre) / patch.reach, dim);
  Eigen::MatrixXd of = Eigen::MatrixXd::Zero(at_place.size(), at_place.size()),
                  right = Eigen::MatrixXd::Zero(at_place.size(), 3);
  const auto sample = [&](const Vec3& x, const Vec3& value) {
    const Vec3 d = (x - centre) / patch.reach;
    const Eigen::VectorXd phi = terms(d, dim);
    const double weight = 1 / (near_weight + d.squaredNorm());
    of += weight * phi * phi.transpose();
    right += weight * phi * value.transpose();
  };
  const auto add = [&](const Vec3& x, const Vec3& value) {
    sample(x, value);
    for (const MirrorPlane& m : patch.mirrors) sample(m.image(x), m.reflect(value));
  };
  for (const Index c : patch.cells) add(g.cell_centre[c], elastic::vector_at(cell_u, c, dim));
  for (const Index f : patch.faces)
    add(g.face_centre[f], elastic::vector_at(face_u, f - mesh.n_interior, dim));
  // Thin cells make terms of very different sizes.
  const Eigen::VectorXd scale =
      of.diagonal().unaryExpr([&](double v) { return v > round_off * of(0, 0) ? 1 / std::sqrt(v) : 0; });
  of = (scale.asDiagonal() * of * scale.asDiagonal()).eval();
  of.diagonal().array() += least;
  const Eigen::MatrixXd c = scale.asDiagonal() * of.llt().solve(scale.asDiagonal() * right);
  return c.transpose() * at_place;
}

}  // namespace couplet::solid
