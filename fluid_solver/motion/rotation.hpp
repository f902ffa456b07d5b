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

/// Integral of (grad u)^T.n over a face [m^2/s] from the velocities of its corners alone: the share of friction on a wall that
/// comes from its motion along itself and its rotation. Where div u = 0, (grad u)^T.n = (n x grad) x u, and by
/// Stokes' theorem its integral is that of dl x u around the face: exact for linear velocities (w x r gives -w x S),
/// and the edges of a closed wall cancel. `corners` [m], `velocities` [m/s]: one after the other around the face, as
/// the mesh has them; in two dimensions the places do not count.
template <int D>
Vec<D> turn_of(std::span<const Vec3> corners, std::span<const Vec3> velocities);

/// Sets `turn` at the faces of a patch from the velocities of their corners, face by face. `points`: of the mesh.
template <int D>
void set_turn(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points,
              std::span<const Vec3> velocities, Vectors<D>& turn);

/// Corners of the faces of a patch, one after the other around each face.
std::vector<Vec3> face_corners(const mesh::Mesh& mesh, const mesh::Patch& patch,
                               std::span<const Vec3> points);

/// Sets w at the faces of a patch to the means of the velocities of their corners, which stand face by face.
template <int D>
void set_face_means(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> velocities,
                    Vectors<D>& w);

/// Force on what is outside by the transposed gradient, -mu T; that by du/dn is the flux of Loads.
template <int D>
Vec<D> turning_force(double viscosity, const Vec<D>& turn) {
  return -viscosity * turn;
}

/// Sets w [m/s] at the faces of bodies to the velocity with which their motion begins at `time`, and, where it is not
/// empty, the turn of these faces (see turn_of()); both per boundary face. Gives the largest speed. Collective.
template <int D>
double set_body_start(const mesh::Mesh& mesh, std::span<const Vec3> points, const Boundary<D>& boundary,
                      const fv::MotionParameters& motion, double time, Vectors<D>& w, Vectors<D>& turn);

}  // namespace couplet::fluid
