// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "plate_modal/model/body_parameters.hpp"
#include "plate_modal/motion/oscillators.hpp"

namespace couplet::plate {

/// Placement and motion of a rigid body at an accepted or trial time. Vectors refer to fixed axes unless they are said to be material,
/// which means that they rotate with the body and equal the fixed ones at the start.
struct BodyState {
  Vec3 translation = Vec3::Zero();                         ///< of the reference point from the start [m]
  Eigen::Vector4d orientation = Eigen::Vector4d::UnitW();  ///< unit quaternion: x, y, z, w
  Vec3 turned = Vec3::Zero();    ///< rotation vector [rad]; its length counts on beyond half a turn
  Vec3 velocity = Vec3::Zero();  ///< of the center of dynamics [m/s]
  Vec3 spin = Vec3::Zero();      ///< angular velocity, material [rad/s]
  double dt = 0;                 ///< of the last step [s]; 0 if none
  Energies energies;

  Tensor3 rotation() const { return Eigen::Quaterniond(orientation).toRotationMatrix(); }
  /// Angular velocity [rad/s].
  Vec3 angular_velocity() const { return rotation() * spin; }
  /// Data for checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(translation, orientation, turned, velocity, spin, dt, energies);
  }
};

/// Forces on the faces of a rigid body, summed for any rotation R of it: sum F, and the first moment sum X F^T with the material
/// vector X from the reference point to a face. The moment about that point is the axial vector of R (sum X F^T).
struct BodyLoad {
  Vec3 force = Vec3::Zero();         ///< [N]
  Tensor3 moment = Tensor3::Zero();  ///< [N m]

  void add(const Vec3& arm, const Vec3& by) {
    force += by;
    moment += arm * by.transpose();
  }
  /// Moment about the reference point after the rotation, or after a mean of rotations [N m].
  Vec3 about_reference(const Tensor3& rotation) const;
};

/// Dynamics of a rigid body with up to six degrees of freedom [simo1991]. Over a step the mid-point rule holds for the momentum and
/// for the angular momentum, and the rotation of the step is a Cayley transform, by which the work of the forces equals the change
/// of energy to rounding for any step:
///
///   R1 = cay(theta) R0,  x1 - x0 = dP + theta x (R0 + R1) X / 2        points X of the body
///   dt (W0 + W1) / 2 = R0^T theta                                      material angular velocity
///   m (U1 - U0) / dt = sum F                                           free translations
///   (R1 J W1 - R0 J W0) / dt + s x m (U1 - U0) / dt = M                free rotations
///
/// The center of dynamics is the reference point if it does not move, and the center of mass otherwise. U is its velocity, J the
/// inertia about it and s the vector to it from the reference point P, at mid-step.
class BodyMotion final {
 public:
  BodyMotion(const BodyParameters& parameters, const Vec3& gravity);

  /// State at the start with this velocity of the reference point [m/s].
  BodyState start(const Vec3& velocity) const;
  /// Advances `now` over dt to `next` under the mean load of the step. Throws SolveFailure if Newton's method does not converge.
  void step(const BodyState& now, double dt, const BodyLoad& load, BodyState& next);
  /// Sets kinetic, strain, gravity and contact energy of the state.
  void set_energies(BodyState& state) const;

  /// Displacement [m] and velocity [m/s] of the point with the material vector `arm` from the reference point.
  Vec3 displacement(const BodyState& state, const Vec3& arm) const;
  Vec3 velocity(const BodyState& state, const Vec3& arm) const;
  /// Velocity of the reference point [m/s].
  Vec3 reference_velocity(const BodyState& state) const;
  /// Angular momentum about the center of dynamics [kg m^2/s].
  Vec3 angular_momentum(const BodyState& state) const;
  /// Velocities of the free degrees of freedom times the square root of their inertia, whose squares add up to twice the kinetic energy.
  std::vector<double> weighted_velocity(const BodyState& state) const;

  std::size_t n_free() const { return translations_.size() + rotations_.size(); }
  int newton_iterations() const { return iterations_; }  ///< of the last step
  /// Shortest duration of an impact on a stop, pi sqrt(m / k) [s]; infinite without stops.
  double shortest_impact() const;
  /// Inertia of free degree of freedom i: mass [kg], or moment about its axis at the start [kg m^2].
  double inertia(std::size_t i) const;

 private:
  static constexpr int most = 6;
  using Unknown = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
  /// Elastic stop of a degree of freedom, with the damper that makes its restitution.
  struct Limit {
    std::size_t free;           // degree of freedom
    double sign, place;         // 1: most, -1: least; position [m] or [rad]
    double stiffness, damping;  // [N/m], [N s/m] or about the axis
  };
  struct Trial {
    Vec3 shift, turn;  // of the reference point [m]; Cayley vector theta [rad]
    Tensor3 rotation, mean;
    Vec3 turned, velocity, spin;
    Vec3 arm;  // s
  };

  void add_limits(const Stops& stops);
  Trial trial(const BodyState& now, double dt, const Unknown& x) const;
  void set_smooth(const BodyState& now, double dt, const BodyLoad& load, const Trial& trial,
                  Unknown& residual) const;
  void add_stops(const BodyState& now, double dt, const Trial& trial, const Unknown& x, Unknown& residual,
                 Jacobian* tangent) const;
  double coordinate(const Limit& limit, const Vec3& translation, const Vec3& turned) const;
  Vec3 spring_moment(const Vec3& before, const Vec3& after, const Vec3& turn) const;
  void add_work(const BodyState& now, double dt, const BodyLoad& load, const Trial& trial,
                BodyState& next) const;
  Eigen::Vector4d turned_by(const Eigen::Vector4d& orientation, const Vec3& turn) const;
  Vec3 rotation_vector(const Eigen::Vector4d& orientation, const Vec3& near) const;

  std::vector<Vec3> translations_, rotations_;
  double mass_;        // of the center of dynamics
  double whole_mass_;  // that gravity acts on
  Tensor3 inertia_;    // about the center of dynamics, material
  Vec3 offset_,
      center_;  // from the reference point to the center of dynamics and to the center of mass, material
  Vec3 gravity_;
  Vec3 stiffness_ = Vec3::Zero(), turn_stiffness_ = Vec3::Zero(), rest_ = Vec3::Zero(),
       turn_rest_ = Vec3::Zero();
  Vec3 damping_ = Vec3::Zero(), turn_damping_ = Vec3::Zero();
  Vec3 initial_spin_;
  std::vector<Limit> limits_;
  double length_ = 1;  // that compares rotations with translations [m]
  int iterations_ = 0;
};

}  // namespace couplet::plate
