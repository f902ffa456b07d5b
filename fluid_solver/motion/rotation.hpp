// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "common/fv/expression.hpp"
#include "common/fv/prescribed_motion.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Frame rotating with omega(t) about an axis through c, in which the mesh and the velocities are described.
/// Forces per mass in it [m/s^2] (Batchelor 1967, (3.2.10)):
///   -2 omega x u  (Coriolis)  - d omega/dt x (x - c)  (Euler)  + grad |omega x (x - c)|^2 / 2  (centrifugal)
/// The pressure balances the centrifugal force, which is a gradient. The equation solves for p - rho |omega x
/// (x - c)|^2 / 2, so that no mesh sets a fluid at rest in motion. Boundaries, walls and files use p.
template <int D>
class RotatingFrame {
 public:
  /// Throws Error if the speed cannot be parsed or depends on position.
  explicit RotatingFrame(const RotationParameters& parameters);

  /// Adds the mean Coriolis and Euler forces over the step from t to t + dt to `force`. `u`, `u_old`: at t
  /// and one step before, extrapolated to mid-step by the factors (u_old is not read if its factor is 0). d
  /// omega/dt is the change over the step, so a frame that jumps to its speed accelerates the fluid.
  void add_force(double t, double dt, std::span<const Vec3> places, const Vectors<D>& u,
                 const Vectors<D>& u_old, std::array<double, 2> factors, Vectors<D>& force) const;
  /// Returns the vector of the angular velocity at time t [rad/s].
  Vec3 omega(double t) const { return speed(t) * axis_; }
  const Vec3& centre() const { return centre_; }
  /// |2 omega|, the larger rate of the Coriolis force at the two ends of a step [1/s].
  double rate(double t, double dt) const;

 private:
  double speed(double t) const { return speed_(Vec3::Zero(), t); }

  fv::Expression speed_;  // [rad/s]
  Vec3 centre_, axis_;
};

/// Integral of (grad u)^T.n over a face [m^2/s] from the velocities of its corners alone: the share of friction on a wall that
/// comes from its motion along itself and its rotation. Where div u = 0, (grad u)^T.n = (n x grad) x u, and by
/// Stokes' theorem its integral is that of dl x u around the face: exact for linear velocities (w x r gives -w x S),
/// and the edges of a closed wall cancel. `corners` [m], `velocities` [m/s]: one after the other around the face, as
/// the mesh has them; in two dimensions the places do not count.
template <int D>
Vec<D> turn_of(std::span<const Vec3> corners, std::span<const Vec3> velocities);

/// Sets `turn` at the faces of a patch from the velocities of their corners. `points`: mesh points.
template <int D>
void set_turn(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points,
              std::span<const Vec3> velocities, Vectors<D>& turn);

/// Corners of the faces of a patch, in order around each face.
std::vector<Vec3> face_corners(const mesh::Mesh& mesh, const mesh::Patch& patch,
                               std::span<const Vec3> points);

/// Sets w at the faces of a patch to the means of the velocities of their corners, given face by face.
template <int D>
void set_face_means(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> velocities,
                    Vectors<D>& w);

/// Force on the surroundings by the transposed gradient, -mu T. Loads contains the force by du/dn.
template <int D>
Vec<D> turning_force(double viscosity, const Vec<D>& turn) {
  return -viscosity * turn;
}

/// Sets w [m/s] at body faces to the initial velocity of their motion at `time`, and their turn (see
/// turn_of()) if that is not empty; both per boundary face. Returns the largest speed. Collective.
template <int D>
double set_body_start(const mesh::Mesh& mesh, std::span<const Vec3> points, const Boundary<D>& boundary,
                      const fv::MotionParameters& motion, double time, Vectors<D>& w, Vectors<D>& turn);

}  // namespace couplet::fluid
