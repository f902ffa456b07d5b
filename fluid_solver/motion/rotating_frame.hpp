// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "common/fv/expression.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// A frame that turns with omega(t) about an axis through c, seen from which mesh and velocities rest or move.
/// Forces per mass [m/s^2] in it (Batchelor 1967, (3.2.10)):
///   -2 omega x u  (Coriolis)  - d omega/dt x (x - c)  (Euler)  + grad |omega x (x - c)|^2 / 2  (centrifugal)
/// The last one is a gradient, which the pressure balances wherever it can: the pressure equation solves for
/// p - rho |omega x (x - c)|^2 / 2, so that no mesh makes a flow of what is at rest; p itself is what boundaries
/// give, walls feel and files show.
template <int D>
class RotatingFrame {
 public:
  /// Throws Error for a speed that cannot be read or depends on the place.
  explicit RotatingFrame(const RotationParameters& parameters);

  /// Adds the mean of Coriolis and Euler force over the step from t to t + dt to `force`, per place. `u`, `u_old`: at
  /// t and one step before; their factors extrapolate to the step's middle (the second is not read where it is 0).
  /// d omega/dt is the change over the step, so that a frame that jumps to its speed pushes the fluid by the jump.
  void add_force(double t, double dt, std::span<const Vec3> places, const Vectors<D>& u,
                 const Vectors<D>& u_old, std::array<double, 2> factors, Vectors<D>& force) const;
  /// |omega x (x - c)|^2 / 2 at time t [m^2/s^2].
  double potential(double t, const Vec3& x) const;
  /// |2 omega|, the largest rate of the Coriolis force at either end of a step [1/s].
  double rate(double t, double dt) const;

 private:
  double speed(double t) const { return speed_(Vec3::Zero(), t); }

  fv::Expression speed_;  // [rad/s]
  Vec3 centre_, axis_;
};

/// Adds `factor` times |omega x (x - c)|^2 / 2 at the level's time, in the cells and at the boundary.
template <int D>
void add_centrifugal(const RotatingFrame<D>& frame, const Placement<D>& at, double factor,
                     PressureLevel<D>& level);

}  // namespace couplet::fluid
