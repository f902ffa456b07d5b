// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::plate {

/// Point of a rigid body that does not move, and the axis through it that the body turns about.
struct Hinge {
  Vec3 point = Vec3::Zero();  ///< at the start [m]
  Vec3 axis = Vec3::UnitZ();  ///< of any length
};

/// Linear springs at the reference point, along and about the fixed axes x, y, z.
struct Springs {
  Vec3 translation = Vec3::Zero();  ///< stiffness [N/m]
  std::vector<double> rotation;  ///< stiffness [N m/rad]: about x, y, z, or about the only axis of rotation
  Vec3 rest_translation = Vec3::Zero();  ///< displacement without spring force [m]
  std::vector<double> rest_rotation;     ///< rotation vector without spring moment [rad]
};

/// Linear dampers at the reference point, along and about the fixed axes x, y, z.
struct Dampers {
  Vec3 translation = Vec3::Zero();  ///< [N s/m]
  std::vector<double> rotation;     ///< [N m s/rad]
};

/// Limits of one coordinate of a body, each an elastic stop that may dissipate energy.
struct Stop {
  std::optional<double> least, most;  ///< [m] or [rad], from the start
  double stiffness = 0;               ///< [N/m] or [N m/rad]
  double restitution = 1;             ///< speed after an impact over that before it
};

/// Stops by the coordinate that they limit.
struct Stops {
  std::optional<Stop> x, y, z, rotation;
};

/// Rigid body with up to six degrees of freedom, as the keys of `body` describe it. A planar body has a depth of 1 m.
struct BodyParameters {
  int dimension = 3;
  std::vector<std::string> surface;  ///< patches of the mesh; empty without a mesh
  double mass = 0;                   ///< [kg]
  Vec3 center_of_mass = Vec3::Zero();
  std::vector<double> inertia;          ///< [kg m^2], about the center of mass: 1, 3 or 6 numbers
  std::vector<double> reference_point;  ///< [m]; empty: hinge or center of mass
  std::vector<std::string> held;
  std::optional<Hinge> hinge;
  std::optional<Springs> springs;
  std::optional<Dampers> dampers;
  std::optional<Stops> stops;
  Vec3 initial_angular_velocity = Vec3::Zero();  ///< [rad/s]

  bool holds(const std::string& word) const;
  /// Point of the body whose translations are held, sprung, damped, stopped and written, at the start [m].
  Vec3 reference() const;
  /// Directions of the free translations of the reference point, unit vectors.
  std::vector<Vec3> translations() const;
  /// Axes of the free rotations, unit vectors.
  std::vector<Vec3> rotations() const;
  /// Inertia tensor about the center of mass, at the start [kg m^2].
  Tensor3 inertia_tensor() const;
};

/// Declares the keys of `body`.
void declare(config::Section& section, BodyParameters& parameters);

/// Problem of a body with this initial velocity of its reference point [m/s], or an empty text.
std::string problem_of_velocity(const BodyParameters& body, const Vec3& velocity);

}  // namespace couplet::plate
