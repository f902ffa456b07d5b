// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing {

inline std::vector<std::string> texts(const Vec3& x, int dim) {
  std::vector<std::string> result;
  for (int a = 0; a < dim; ++a) result.push_back(fmt::format("{:.17g}", x[a]));
  return result;
}

inline SolidBoundary with_force(Type type, const Vec3& force, int dim) {
  SolidBoundary b = boundary(type);
  for (const std::string& text : texts(force, dim)) b.load.force.push_back({text});
  return b;
}

/// Gravity against y.
inline SolidBoundary liquid(double density, double gravity, const std::string& level, int dim) {
  SolidBoundary b = boundary(Type::hydrostatic_pressure);
  b.load.density = density;
  b.load.gravity.assign(std::size_t(dim), 0);
  b.load.gravity[1] = -gravity;
  b.load.level = {level};
  return b;
}

/// Calls take(face, force [N]) for the loaded faces of this rank.
template <class Take>
void visit_loads(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const SolidParameters& p,
                 const Take& take, double t = 0) {
  const SolidBoundaries boundaries(mesh, geometry, p);
  std::vector<double> forces(std::size_t(mesh.boundary.n_owned()) * mesh.dim, 0);
  boundaries.add_forces(t, forces);
  for (Index b = 0; b < mesh.boundary.n_owned(); ++b) {
    Vec3 push = Vec3::Zero();
    for (int a = 0; a < mesh.dim; ++a) push[a] = forces[std::size_t(b) * mesh.dim + a];
    if (push.norm() > 0) take(mesh.n_interior + b, push);
  }
}

/// Of all ranks; the moment is about the origin.
struct Resultant {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double loaded = 0;  ///< faces
};
inline Resultant resultant(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const SolidParameters& p,
                           double t = 0) {
  Resultant r;
  visit_loads(
      mesh, geometry, p,
      [&](Index f, const Vec3& push) {
        r.force += push;
        r.moment += geometry.face_centre[f].cross(push);
        ++r.loaded;
      },
      t);
  for (int a = 0; a < 3; ++a) {
    r.force[a] = parallel::sum(mesh.comm, r.force[a]);
    r.moment[a] = parallel::sum(mesh.comm, r.moment[a]);
  }
  r.loaded = parallel::sum(mesh.comm, r.loaded);
  return r;
}

/// Radii 1 to 2 above the x axis, the inner side being "ymin"; n cells around.
inline mesh::RawMesh half_ring(mesh::BoxCells cells, int n) {
  mesh::RawMesh raw = mesh::make_box(cells, {n, 3, 2}, Vec3::Zero(), Vec3::Ones());
  for (Vec3& x : raw.points) {
    const double angle = std::numbers::pi * (1 - x[0]), radius = 1 + x[1];
    x = {radius * std::cos(angle), radius * std::sin(angle), x[2]};
  }
  return raw;
}

/// Mean displacement of the faces of a patch.
inline Vec3 mean_on(const Solid& solid, const std::string& name) {
  const mesh::Mesh& mesh = solid.body().mesh();
  const mesh::Geometry& geometry = solid.body().geometry();
  Vec3 total = Vec3::Zero();
  double area = 0;
  for (const mesh::Patch& patch : mesh.patches)
    for (Index f = patch.first; patch.name == name && f < patch.first + patch.count; ++f) {
      const double size = geometry.face_area[f].norm();
      area += size;
      for (int a = 0; a < mesh.dim; ++a)
        total[a] += size * solid.stepper().state().face_u[std::size_t(f - mesh.n_interior) * mesh.dim + a];
    }
  area = parallel::sum(mesh.comm, area);
  for (int a = 0; a < 3; ++a) total[a] = parallel::sum(mesh.comm, total[a]) / area;
  return total;
}

/// Of cells and of faces that have mass [kg m/s].
inline Vec3 momentum_of(const Solid& solid) {
  const SolidBody& body = solid.body();
  const mesh::Mesh& mesh = body.mesh();
  const mesh::Geometry& geometry = body.geometry();
  const SolidState& state = solid.stepper().state();
  Vec3 total = Vec3::Zero();
  for (int a = 0; a < mesh.dim; ++a) {
    if (body.has_mass()) {
      std::vector<double> one(state.cell_v.size(), 0), on_faces(state.face_v.size(), 0);
      for (std::size_t i = std::size_t(a); i < one.size(); i += std::size_t(mesh.dim)) one[i] = 1;
      for (std::size_t i = std::size_t(a); i < on_faces.size(); i += std::size_t(mesh.dim)) on_faces[i] = 1;
      const std::vector<double> v = body.unknowns_of(state.cell_v, state.face_v),
                                e = body.unknowns_of(one, on_faces);
      total[a] = body.kernel().product(elastic::ElasticPart::mass, {v, state.known_rate}, {e, {}});
    } else {
      for (Index c = 0; c < mesh.cells.n_owned(); ++c)
        total[a] += body.density(c) * geometry.volume[c] * state.cell_v[std::size_t(c) * mesh.dim + a];
    }
    total[a] = parallel::sum(mesh.comm, total[a]);
  }
  return total;
}

}  // namespace couplet::testing
