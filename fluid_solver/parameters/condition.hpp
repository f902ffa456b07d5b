// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/grid_table.hpp"

namespace couplet::fluid {

enum class BoundaryType {
  inlet,
  outlet,
  convective_outlet,
  no_slip,
  moving_wall,
  partial_slip,
  slip,
  symmetry,
  periodic,
  interface,
  body
};
enum class InletProfile { uniform, parabolic };

/// Velocities in a file, see GridTable: columns u, v (and w) over some of x, y, z, t.
struct VelocityTableParameters {
  std::string file;
  fv::GridTable::Outside outside = fv::GridTable::Outside::error;
};

/// omega(t) a x (x - c), besides the other velocity.
struct RotationParameters {
  config::ExpressionText speed;                      // [rad/s], of t
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();  // [m]
};

/// Who says what mass per area stands behind an interface of type Robin.
enum class Impedance { given, structure };
/// Motion of Robin faces on the two sides of a thin body.
enum class Sides { automatic, together, apart };

/// The keys of all conditions; what a condition does not read stays as it is here.
struct BoundaryParameters {
  BoundaryType type = BoundaryType::no_slip;
  std::vector<config::ExpressionText> velocity;      // [m/s], inlet and moving wall
  std::optional<VelocityTableParameters> table;      // instead of velocity; inlet and moving wall
  std::optional<RotationParameters> rotation;        // inlet and moving wall
  std::optional<config::ExpressionText> mean_speed;  // [m/s] into the domain, of t; inlet
  InletProfile profile = InletProfile::uniform;      // of mean_speed
  std::optional<double> ramp;                        // [s], inlet and moving wall
  config::ExpressionText pressure;                   // [Pa], outlet
  bool backflow_stabilisation = true;                // outlet
  bool absorbing = false;                            // inlet and outlet: lets waves out
  double slip_length = 0;                            // [m], partial slip
  std::string partner;                               // periodic
  std::optional<double> surface_density;             // [kg/m^2], interface: of the structure behind it
  Impedance impedance = Impedance::given;            // interface
  Sides sides = Sides::automatic;                    // interface
  /// The wall's answer is foreseen in the pressure equation.
  bool foresees() const { return surface_density || impedance == Impedance::structure; }
};

/// Numbers that a condition gives to the equations at each of its faces: with w the velocity and p_b the pressure that
/// are given, L the slip length, g the conductance and S the area of a face, t = S/(S + L g), n its normal, P its cell,
///   flux            phi = w.S                            ; of a given pressure: phi^p - (dt/rho) g (p_b - p_P)
///   pressure row    nothing, p_b from the wall's motion  ; of a given pressure: g, and g p_b on the right side
///   viscous row     beta g [t I + (1 - t) n n], and the same of w on the right side; of a given pressure: nothing
///   value at b      u_b = u_P + [t I + (1 - t) n n] (w - u_P)                      ; of a given pressure: u_P
///   load            p_b S + mu g (u_P - u_b)
struct FaceRow {
  double pressure = 0;     ///< 1: the pressure is given, w is not
  double slip_length = 0;  ///< L [m], mu du/dn = mu (w - u_b)/L along the wall; infinity: no friction
  double inflow = 1;       ///< share of u_b that comes in with a flux into the domain
};
inline constexpr double no_friction = std::numeric_limits<double>::infinity();

/// Who gives w.
enum class GivenBy {
  rest,       ///< it is zero
  keys,       ///< of the condition
  mesh,       ///< the normal velocity of the mesh
  structure,  ///< at an interface
  motion,     ///< prescribed, or of the mesh mover
  flow,       ///< what arrives
  nobody,     ///< there is none: the pressure is given, or there are no faces
};
enum class Passage { none, in, out };

/// A boundary condition: its keys, and what it gives to flux, pressure row, viscous row, boundary value and load at each of its faces,
/// as numbers. The loops over faces read these from flat arrays and never ask for a type. A new condition touches conditions.cpp and its
/// name in BoundaryType.
struct Condition {
  std::string name;   ///< in the YAML
  std::string about;  ///< its part of the documentation of `type`; empty if another tells it
  void (*declare)(config::Section&, BoundaryParameters&) = nullptr;  ///< its keys; nullptr if it has none
  FaceRow (*row)(const BoundaryParameters&) = [](const BoundaryParameters&) { return FaceRow(); };
  GivenBy velocity = GivenBy::rest;
  Passage passage = Passage::none;  ///< of the fluid, as expected
  bool wall = false;                ///< exerts friction on the fluid and bears its force
  bool joined = false;              ///< its faces are interior ones
};

/// Condition of a patch.
const Condition& condition_of(const BoundaryParameters& boundary);
inline bool is_wall(const BoundaryParameters& b) { return condition_of(b).wall; }
inline bool gives_pressure(const BoundaryParameters& b) { return condition_of(b).row(b).pressure > 0; }
/// A wall whose velocity the case gives.
inline bool is_moving_wall(const BoundaryParameters& b) {
  return is_wall(b) && condition_of(b).velocity == GivenBy::keys;
}

/// All names, with `last` before the last one.
std::string condition_names(const std::string& last);
/// `type` and the keys that it brings.
void declare_boundary(config::Section& section, BoundaryParameters& parameters);
void declare_rotation(config::Section& section, RotationParameters& rotation);

}  // namespace couplet::fluid
