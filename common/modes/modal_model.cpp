// SPDX-License-Identifier: Apache-2.0
#include "common/modes/modal_model.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace couplet::modes {

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
  // Of sizes known at run time: of a fixed 3x3 GCC 12 takes Eigen's AVX code for a read past its end.
  motion.rotation = Eigen::MatrixXd(inertia).completeOrthogonalDecomposition().solve(Eigen::VectorXd(moment));
  double left = 0, all = 0;
  for (std::size_t v = 0; v < n_vertices; ++v) {
    const Vec3 u = shape(v);
    left += (u - motion.translation - motion.rotation.cross(model.vertices[v] - centre)).squaredNorm();
    all += u.squaredNorm();
  }
  if (all > 0) motion.misfit = std::sqrt(left / all);
  return motion;
}

std::vector<Vec3> face_centres(const ModalModel& model) {
  std::vector<Vec3> centres;
  for (Index f = 0; f < model.faces.size(); ++f) {
    Vec3 centre = Vec3::Zero();
    for (const Index v : model.faces[f]) centre += model.vertices[v];
    centres.push_back(centre / double(model.faces[f].size()));
  }
  return centres;
}

Vec3 extent_of(const ModalModel& model) {
  Vec3 low = model.vertices.front(), high = low;
  for (const Vec3& x : model.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
  return high - low;
}

std::vector<Vec3> face_areas(const ModalModel& model) {
  std::vector<Vec3> areas;
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto v = model.faces[f];
    const Vec3 a = model.vertices[v[2]] - model.vertices[v[0]];
    const Vec3 b = v.size() == 3 ? Vec3(model.vertices[v[2]] - model.vertices[v[1]])
                                 : Vec3(model.vertices[v[3]] - model.vertices[v[1]]);
    // A triangle: (x2 - x0) x (x2 - x1) / 2 has the sign of (x1 - x0) x (x2 - x0) / 2.
    areas.push_back(v.size() == 3 ? Vec3(0.5 * (model.vertices[v[1]] - model.vertices[v[0]]).cross(a))
                                  : Vec3(0.5 * a.cross(b)));
  }
  return areas;
}

void average_faces(ModalModel& model) {
  const std::size_t n = model.n_modes();
  model.face_shape.assign(std::size_t(model.faces.size()) * 3 * n, 0);
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (const Index v : corners)
      for (std::size_t i = 0; i < 3 * n; ++i)
        model.face_shape[std::size_t(f) * 3 * n + i] +=
            model.vertex_shape[std::size_t(v) * 3 * n + i] / double(corners.size());
  }
}

double largest_displacement(const ModalModel& model, std::size_t mode) {
  const std::size_t n = model.n_modes();
  double largest = 0;
  for (std::size_t v = 0; v < model.vertices.size(); ++v) {
    const double* u = model.vertex_shape.data() + 3 * v * n + mode;
    largest = std::max(largest, Vec3(u[0], u[n], u[2 * n]).norm());
  }
  return largest;
}

}  // namespace couplet::modes
