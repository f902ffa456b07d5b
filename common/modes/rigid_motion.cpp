// SPDX-License-Identifier: Apache-2.0
#include "common/modes/rigid_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <utility>

namespace couplet {

RigidMotion rigid_motion(const ModalModel& model, std::size_t mode) {
  RigidMotion motion;
  const std::size_t n = model.n_modes(), n_vertices = model.vertices.size();
  if (n_vertices == 0) return motion;
  const auto shape = [&](std::size_t v) {
    const double* u = model.vertex_shape.data() + 3 * v * n + mode;
    return Vec3(u[0], u[n], u[2 * n]);
  };
  Vec3 centre = Vec3::Zero();
  for (std::size_t v = 0; v < n_vertices; ++v) {
    centre += model.vertices[v] / double(n_vertices);
    motion.translation += shape(v) / double(n_vertices);
  }
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vec3 moment = Vec3::Zero();
  for (std::size_t v = 0; v < n_vertices; ++v) {
    const Vec3 r = model.vertices[v] - centre;
    inertia += r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
    moment += r.cross(shape(v));
  }
  motion.rotation = inertia.completeOrthogonalDecomposition().solve(moment);
  double left = 0, all = 0;
  for (std::size_t v = 0; v < n_vertices; ++v) {
    const Vec3 u = shape(v);
    left += (u - motion.translation - motion.rotation.cross(model.vertices[v] - centre)).squaredNorm();
    all += u.squaredNorm();
  }
  if (all > 0) motion.misfit = std::sqrt(left / all);
  return motion;
}

std::string surface_problem_of(const ModalModel& model) {
  std::vector<bool> used(model.vertices.size(), false);
  std::map<std::pair<Index, Index>, std::vector<Index>>
      faces_of;  // of an edge in the direction in which they go
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Index from = corners[i], to = corners[(i + 1) % corners.size()];
      used[std::size_t(from)] = true;
      for (std::size_t j = 0; j < i; ++j)
        if (corners[j] == from) return fmt::format("face {} names vertex {} twice", f + 1, from);
      faces_of[{from, to}].push_back(f);
    }
  }
  // More than two faces at an edge may be two bodies that touch there: they turn alike in pairs.
  for (const auto& [edge, faces] : faces_of)
    if (faces.size() > 1 && !faces_of.contains({edge.second, edge.first}))
      return fmt::format(
          "faces {} and {} go along their edge between vertices {} and {} in the same direction: one of them is turned "
          "inside out",
          faces[0] + 1, faces[1] + 1, edge.first, edge.second);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v]) return fmt::format("no face has vertex {}", v);
  return "";
}

}  // namespace couplet
