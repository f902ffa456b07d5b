// SPDX-License-Identifier: Apache-2.0
#include "common/modes/rigid_motion.hpp"

#include <Eigen/Dense>
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

}  // namespace couplet::modes
