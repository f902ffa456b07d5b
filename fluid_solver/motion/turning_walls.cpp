// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/turning_walls.hpp"

#include <Eigen/Geometry>

#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// 2-D: a face is as deep as the scene, its edges along z are left at corner 0 and right at corner 1:
/// e_z x (u_1 - u_0), see Mesh for the order.
template <int D>
Vec<D> turn_of(std::span<const Vec3> corners, std::span<const Vec3> velocities) {
  if constexpr (D == 2) {
    const Vec3 jump = velocities[1] - velocities[0];
    return {-jump.y(), jump.x()};
  } else {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0, last = corners.size() - 1; i < corners.size(); last = i++)
      sum += (corners[i] - corners[last]).cross(0.5 * (velocities[i] + velocities[last]));
    return sum;
  }
}

template <int D>
void set_turn(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points,
              std::span<const Vec3> velocities, Vectors<D>& turn) {
  std::vector<Vec3> corners;
  std::size_t first = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    corners.clear();
    for (const Index v : mesh.face_points[f]) corners.push_back(points[v]);
    turn[f - mesh.n_interior] = turn_of<D>(corners, velocities.subspan(first, corners.size()));
    first += corners.size();
  }
}

/// Of the walls whose velocity the case gives; the others' was given before.
template <int D>
void Boundary<D>::add_turn(const mesh::Mesh& mesh, std::span<const Vec3> points, double t,
                           Vectors<D>& turn) const {
  for (const GivenVelocity<D>& given : velocity_patches_) {
    if (!given.turns()) continue;
    const mesh::Patch& patch = given.patch();
    std::vector<Vec3> corners;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      for (const Index v : mesh.face_points[f]) corners.push_back(points[v]);
    std::vector<Vec3> velocities(corners.size(), Vec3::Zero());
    Vectors<D> w(corners.size(), Vec<D>::Zero());
    given.evaluate(t, corners, w.data());
    for (std::size_t i = 0; i < w.size(); ++i) velocities[i].template head<D>() = w[i];
    set_turn<D>(mesh, patch, points, velocities, turn);
  }
}

/// Mean of the step's begin and end.
template <int D>
void Fluid<D>::add_turning() {
  if (!boundary_.walls_turn()) return;
  turn_ = given_turn_;
  turn_.resize(viscous_force_.size(), Vec<D>::Zero());
  const std::vector<Vec3>& points = step_.points().empty() ? points_at_rest() : step_.points();
  boundary_.add_turn(mesh_, points, time_ + dt_, turn_);
  for (std::size_t b = 0; b < turn_.size(); ++b) {
    Vec<D> mean = 0.5 * turn_[b];
    if (!accepted_.turn.empty()) mean += 0.5 * accepted_.turn[b];
    viscous_force_[b] += turning_force<D>(parameters_.viscosity, mean);
  }
}

template Vec<2> turn_of<2>(std::span<const Vec3>, std::span<const Vec3>);
template Vec<3> turn_of<3>(std::span<const Vec3>, std::span<const Vec3>);
template void set_turn<2>(const mesh::Mesh&, const mesh::Patch&, std::span<const Vec3>, std::span<const Vec3>,
                          Vectors<2>&);
template void set_turn<3>(const mesh::Mesh&, const mesh::Patch&, std::span<const Vec3>, std::span<const Vec3>,
                          Vectors<3>&);
template void Boundary<2>::add_turn(const mesh::Mesh&, std::span<const Vec3>, double, Vectors<2>&) const;
template void Boundary<3>::add_turn(const mesh::Mesh&, std::span<const Vec3>, double, Vectors<3>&) const;
template void Fluid<2>::add_turning();
template void Fluid<3>::add_turning();

}  // namespace couplet::fluid
