// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/rotating_frame.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::fluid {

template <int D>
RotatingFrame<D>::RotatingFrame(const RotationParameters& p)
    : speed_(p.speed, "rotating-frame.speed"),
      centre_(p.centre),
      axis_(D == 2 ? Vec3(Vec3::UnitZ()) : Vec3(p.axis.normalized())) {
  if (speed_.uses_space()) throw Error("rotating-frame.speed: it may depend on t only.");
}

template <int D>
void RotatingFrame<D>::add_force(double t, double dt, std::span<const Vec3> places, const Vectors<D>& u,
                                 const Vectors<D>& u_old, std::array<double, 2> factors,
                                 Vectors<D>& force) const {
  const Vec3 omega = speed(t + dt / 2) * axis_, change = (speed(t + dt) - speed(t)) / dt * axis_;
  for (std::size_t c = 0; c < places.size(); ++c) {
    Vec3 velocity = Vec3::Zero();
    velocity.template head<D>() = factors[0] * u[c];
    if (factors[1] != 0) velocity.template head<D>() += factors[1] * u_old[c];
    force[c] -= (2 * omega.cross(velocity) + change.cross(places[c] - centre_)).template head<D>();
  }
}

template <int D>
double RotatingFrame<D>::potential(double t, const Vec3& x) const {
  return 0.5 * (speed(t) * axis_.cross(x - centre_)).squaredNorm();
}

template <int D>
double RotatingFrame<D>::rate(double t, double dt) const {
  return 2 * std::max(std::abs(speed(t)), std::abs(speed(t + dt)));
}

template <int D>
void add_centrifugal(const RotatingFrame<D>& frame, const Placement<D>& at, double factor,
                     PressureLevel<D>& level) {
  Vec3 x = Vec3::Zero();
  for (std::size_t c = 0; c < level.p.size(); ++c) {
    x.template head<D>() = at.centre[c];
    level.p[c] += factor * frame.potential(level.time, x);
  }
  for (std::size_t b = 0; b < level.boundary.size(); ++b)
    level.boundary[b] += factor * frame.potential(level.time, at.boundary_centre[b]);
}

template void add_centrifugal<2>(const RotatingFrame<2>&, const Placement<2>&, double, PressureLevel<2>&);
template void add_centrifugal<3>(const RotatingFrame<3>&, const Placement<3>&, double, PressureLevel<3>&);

template class RotatingFrame<2>;
template class RotatingFrame<3>;

}  // namespace couplet::fluid
