// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/local_quadratic.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/elasticity/vector_at.hpp"
#include "common/fv/gradients.hpp"

namespace couplet::solid {
namespace {

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

}  // namespace

Vec3 quadratic_displacement(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index cell,
                            const Vec3& place, std::span<const double> cell_u,
                            std::span<const double> face_u) {
  const mesh::Geometry& g = rows.geometry();
  const int dim = mesh.dim;
  const Neighbours patch = around(mesh, rows, cell);
  const Vec3 centre = g.cell_centre[cell];
  fv::NearQuadratic fit(dim, centre, patch.reach, 3);
  const auto add = [&](const Vec3& x, const Vec3& value) {
    fit.add(x, {value.data(), 3});
    for (const MirrorPlane& m : patch.mirrors) {
      const Vec3 image = m.reflect(value);
      fit.add(m.image(x), {image.data(), 3});
    }
  };
  for (const Index c : patch.cells) add(g.cell_centre[c], elastic::vector_at(cell_u, c, dim));
  for (const Index f : patch.faces)
    add(g.face_centre[f], elastic::vector_at(face_u, f - mesh.n_interior, dim));
  return fit.solve().transpose() * fit.terms(place);
}

}  // namespace couplet::solid
