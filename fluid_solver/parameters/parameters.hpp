// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/grid_table.hpp"
#include "common/fv/prescribed_motion.hpp"

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

/// How the pressure follows from the divergence where the fluid is computed as weakly compressible.
enum class WaveScheme { none, three_level, trapezoidal };

/// The compressibility of a fluid: how it is computed, or, with `none`, by what a run judges whether to neglect it was right.
struct CompressibilityParameters {
  WaveScheme scheme = WaveScheme::three_level;
  std::optional<double> mean_time;       // [s], of the means at absorbing boundaries
  std::optional<double> speed_of_sound;  // [m/s]
  std::string substance;                 // one of substances(); empty: not given
  std::optional<double> temperature;     // [K], of the substance
  std::optional<double> pressure;        // [Pa], absolute; with the density: c^2 = gamma p / rho
  std::optional<double> heat_capacity_ratio;
  double upstream_volume = 0;  // [m^3], before the inlets, not in the mesh
  bool is_solved() const { return scheme != WaveScheme::none; }
};
void declare(config::Section& section, CompressibilityParameters& parameters);

/// Gases by molar mass and ratio of heat capacities, liquids by their speed of sound.
std::vector<std::string> substances();

/// Why a fluid of this density [kg/m^3] cannot be the named substance; empty: it can, or none is named.
std::string misfit_of(const CompressibilityParameters& parameters, double density);

struct Sound {
  double speed = 0;  ///< [m/s]
  std::string of;    ///< "sf6 at 20 degC"
};
/// Speed of sound by the keys, else by density [kg/m^3] and viscosity [Pa s], where they are those of a gas at 1 atm or of a liquid. None for a
/// model fluid, such as one of 1 kg/m^3 and 1 Pa s: nothing is known of its sound.
std::optional<Sound> sound_of(const std::optional<CompressibilityParameters>& parameters, double density,
                              double viscosity);

/// Speed of sound of a fluid that is computed as weakly compressible [m/s], else 0. Throws Error if it is not known.
double solved_sound(const std::optional<CompressibilityParameters>& parameters, double density,
                    double viscosity);

enum class ViscousTreatment { automatic, explicit_, implicit };
/// Scheme of the explicit terms: Adams-Bashforth of two levels, or Heun's Runge-Kutta of three stages.
enum class ExplicitScheme { adams_bashforth, runge_kutta };
/// How the face fluxes follow the cells' velocities from step to step.
enum class Projection { flux_memory, incremental, non_incremental };

/// Order of the operators along lines of hexahedra and quadrilaterals.
enum class FaceValues { second_order, fourth_order, automatic };

/// Who sets the pressure level, and so holds the volume, of a fluid without an outlet.
enum class VolumeLevelBy { nobody, structure };

enum class TurbulenceModel { smagorinsky, wale };

/// Large-eddy simulation; absent: no model, no cost.
struct TurbulenceParameters {
  TurbulenceModel model = TurbulenceModel::wale;
  std::optional<double> constant;  // by default the usual one of the model
  double constant_of() const { return constant.value_or(model == TurbulenceModel::wale ? 0.325 : 0.17); }
};

/// How bodies close the cells of a mesh that does not conform to them.
enum class BodySurface { automatic, steps, cut };

/// A rigid body inside the mesh.
struct BodyParameters {
  config::ExpressionText level;                  // [m], below zero inside
  std::vector<config::ExpressionText> velocity;  // [m/s]; empty: at rest
  BodySurface surface = BodySurface::automatic;
};

/// Two walls between which nothing passes where they are nearer than `opening`.
struct GapParameters {
  std::vector<std::string> between;
  double opening = 0;  // [m]
  /// Height of the seat, the second wall, along `direction` [m]; absent if it is not stated.
  std::optional<config::ExpressionText> height;
  std::vector<double> direction;  // from the seat to the other wall; empty: z, in 2-D y
};

/// Running means from a time on; absent: none.
struct StatisticsParameters {
  double start = 0;  // [s]
};

/// Force and moment coefficients of some walls together.
struct CoefficientParameters {
  std::vector<std::string> patches;
  double speed = 1, area = 1, length = 1;  // [m/s], [m^2] (2-D: m of depth 1 m), [m]
  double pressure = 0;                     // [Pa], that of Cp = 0
  Vec3 drag = Vec3::UnitX(), lift = Vec3::UnitY(), axis = Vec3::UnitZ(), centre = Vec3::Zero();
};

/// Places where velocity and pressure are written at each output: a line (one side) or a plane (two).
struct SampleParameters {
  enum class Type { line, plane };
  Type type = Type::line;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  // [m]; of a plane: two corners, the third is `up`
  Vec3 up = Vec3::Zero();                       // [m]
  int points = 101, rows = 21;                  // along from-to; along from-up
};

/// The effective flow area between two patches.
struct FlowAreaParameters {
  std::string from, to;
};

/// Fields and series beyond velocity, pressure, forces and balance.
struct FluidOutputParameters {
  std::map<std::string, bool> gradient_fields;  // by their names, see gradient_fields.hpp
  bool energy_budget = false, walls = false, fluxes = false;
  std::vector<std::string> surfaces;  // patches, or "all"
  std::map<std::string, CoefficientParameters> coefficients;
  std::map<std::string, FlowAreaParameters> flow_areas;
  std::map<std::string, SampleParameters> samples;
};

struct ProbeParameters {
  Vec3 point = Vec3::Zero();  // [m]
};

/// A fluid by its numbers.
struct Properties {
  double rho = 0;    ///< density [kg/m^3]
  double mu = 0;     ///< dynamic viscosity [Pa s]
  double nu = 0;     ///< kinematic viscosity [m^2/s]
  double sound = 0;  ///< speed of sound [m/s]; 0: incompressible
};

struct FluidParameters {
  std::string mesh;
  std::map<std::string, double> mesh_parameters;
  double mesh_scale = 1;
  int dimension = 3;
  double density = 0;    // [kg/m^3]
  double viscosity = 0;  // dynamic [Pa s]
  std::map<std::string, BoundaryParameters> boundaries;
  std::optional<double> time_step;  // [s]; empty: by the stability limit
  double safety_factor = 0.8;
  ViscousTreatment viscous = ViscousTreatment::automatic;
  /// Largest implicit sub-step over the explicit limit; empty without such a bound.
  std::optional<double> implicit_stretch;
  double pressure_tolerance = 1e-6;
  std::vector<config::ExpressionText> initial_velocity;    // [m/s]; empty: at rest
  std::optional<config::ExpressionText> initial_pressure;  // [Pa]
  std::vector<config::ExpressionText> body_force;          // [m/s^2]; empty: none
  std::optional<TurbulenceParameters> turbulence;
  std::optional<StatisticsParameters> statistics;
  FluidOutputParameters output;
  std::map<std::string, BodyParameters> bodies;
  std::map<std::string, GapParameters> gaps;
  std::optional<fv::MotionParameters> motion;        // of the mesh; absent: none
  std::optional<RotationParameters> rotating_frame;  // that mesh and velocities are seen from; absent: none
  ExplicitScheme scheme = ExplicitScheme::adams_bashforth;
  Projection projection = Projection::flux_memory;
  FaceValues face_values = FaceValues::second_order;
  VolumeLevelBy volume_level = VolumeLevelBy::nobody;
  std::optional<CompressibilityParameters> compressibility;  // absent: none, judged by the density
  std::map<std::string, ProbeParameters> probes;
  /// [m/s]; 0: the fluid is computed as incompressible.
  double sound_speed() const { return solved_sound(compressibility, density, viscosity); }
  bool is_compressible() const { return compressibility && compressibility->is_solved(); }
  double kinematic_viscosity() const { return viscosity / density; }  ///< [m^2/s]
  Properties properties() const { return {density, viscosity, kinematic_viscosity(), sound_speed()}; }
};

/// Pairs of periodic patches. Throws Error if two patches do not name each other.
std::vector<std::array<std::string, 2>> periodic_patches(const FluidParameters& parameters);

void declare(config::Section& section, FluidParameters& parameters);
/// The section `output`.
void declare_output(config::Section& section, FluidOutputParameters& parameters);

}  // namespace couplet::fluid
