// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"
#include "common/diagnostics/choices.hpp"
#include "common/fv/grid_table.hpp"
#include "common/fv/prescribed_motion.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "fluid_solver/parameters/viscosity_law.hpp"

namespace couplet::fluid {

enum class BoundaryType {
  inlet,
  outlet,
  convective_outlet,
  no_slip,
  moving_wall,
  slip,
  symmetry,
  periodic,
  interface,
  body
};
enum class InletProfile { uniform, parabolic };

/// Velocities from a file, see GridTable: columns u, v (and w) over some of x, y, z, t.
struct VelocityTableParameters {
  std::string file;
  fv::GridTable::Outside outside = fv::GridTable::Outside::error;
  std::optional<double> repeat;  // period [s]; absent if they do not repeat
};

/// Three elements of a circuit: a resistance, then a compliance beside a second resistance [westerhof2009].
struct WindkesselParameters {
  double proximal = 0, distal = 0;  // [Pa s/m^3]
  double compliance = 0;            // [m^3/Pa]
  double initial_pressure = 0;      // [Pa], of the compliance, above the outlet's `pressure`
};

/// Circuit between an outlet and its `pressure`; at most one of the three.
struct CircuitParameters {
  std::optional<double> resistance;  // [Pa s/m^3]
  std::optional<WindkesselParameters> windkessel;
  std::optional<config::ExpressionText> pressure_drop;  // [Pa], table of the flow rate q [m^3/s]
  int count() const { return resistance.has_value() + windkessel.has_value() + pressure_drop.has_value(); }
};

/// Adds omega(t) a x (x - c) to the other velocity.
struct RotationParameters {
  config::ExpressionText speed;                      // [rad/s], of t
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();  // [m]
};

/// A layer between the fluid and surroundings of a known temperature; both of x, y, z, t.
struct FilmParameters {
  config::ExpressionText coefficient;        // [W/(m^2 K)]
  config::ExpressionText ambient{"293.15"};  // [K]
};

/// Keys of all conditions; those that a condition does not read keep their defaults.
struct BoundaryParameters {
  BoundaryType type = BoundaryType::no_slip;
  std::vector<config::ExpressionText> velocity;      // [m/s], inlet and moving wall
  std::optional<VelocityTableParameters> table;      // instead of velocity; inlet and moving wall
  std::optional<RotationParameters> rotation;        // inlet and moving wall
  std::optional<config::ExpressionText> mean_speed;  // [m/s] into the domain, of t; inlet
  std::optional<config::ExpressionText> flow_rate;   // [m^3/s] into the domain, of t; inlet
  InletProfile profile = InletProfile::uniform;      // of mean_speed or flow_rate
  std::optional<double> ramp;                        // [s], inlet and moving wall
  config::ExpressionText pressure;                   // [Pa], outlet
  CircuitParameters circuit;                         // outlet
  bool backflow_stabilisation = true;                // outlet
  bool absorbing = false;                            // inlet and outlet: lets waves out
  std::string partner;                               // periodic
  std::optional<double> surface_density;             // [kg/m^2], interface: of the structure behind it
  // With `heat`, at most one of them; without any no heat is conducted through the patch.
  std::optional<config::ExpressionText> temperature;  // [K]
  std::optional<config::ExpressionText> heat_flux;    // [W/m^2] into the fluid
  std::optional<FilmParameters> film;
  bool conjugate = false;  // another participant gives a film and takes the heat
  bool exchanges_heat() const { return temperature || heat_flux || film || conjugate; }
};

/// Coefficients of a condition in the equations of its faces, with given velocity w or pressure p_b,
/// conductance g, area S, share t of the friction along the face, normal n and cell P.
///   flux            phi = w.S; for a given pressure phi^p - (dt/rho) g (p_b - p_P)
///   pressure row    none, p_b follows from the wall's motion; for a given pressure g, and right side g p_b
///   viscous row     beta g [t I + (1 - t) n n], right side that times w; none for a given pressure
///   value at b      u_b = u_P + [t I + (1 - t) n n] (w - u_P); u_P for a given pressure
///   load            p_b S + mu g (u_P - u_b)
struct FaceRow {
  double pressure = 0;  ///< 1 if the pressure is given instead of w
  double friction = 1;  ///< t; 0: the velocity along the face is that of the cell
  double inflow = 1;    ///< share of u_b carried in by a flux into the domain
};

/// Source of w.
enum class GivenBy {
  rest,       ///< it is zero
  keys,       ///< the keys of the condition
  mesh,       ///< the normal velocity of the mesh
  structure,  ///< at an interface
  motion,     ///< prescribed, or by the mesh mover
  flow,       ///< the flow at a convective outlet
  nobody,     ///< not defined, because the pressure is given or there are no faces
};
enum class Passage { none, in, out };

/// Boundary condition: its keys, and its coefficients for flux, pressure row, viscous row, boundary value and
/// load at each face. Face loops read these from flat arrays and never check the type. A new condition only
/// needs an entry in conditions.cpp and a name in BoundaryType.
struct FlowCondition {
  std::string name;   ///< name in the YAML
  std::string about;  ///< its part of the documentation of `type`; empty if another one covers it
  void (*declare)(config::Section&, BoundaryParameters&) = nullptr;  ///< its keys; nullptr if it has none
  FaceRow (*row)(const BoundaryParameters&) = [](const BoundaryParameters&) { return FaceRow(); };
  GivenBy velocity = GivenBy::rest;
  Passage passage = Passage::none;  ///< expected flow direction
  bool wall = false;                ///< exerts friction on the fluid and carries its force
  bool joined = false;              ///< its faces become interior faces
};

/// Condition of a patch.
const FlowCondition& condition_of(const BoundaryParameters& boundary);
inline bool is_wall(const BoundaryParameters& b) { return condition_of(b).wall; }
inline bool gives_pressure(const BoundaryParameters& b) { return condition_of(b).row(b).pressure > 0; }

struct FluidParameters;

/// All names as a list, with `last` before the last one.
std::string condition_names(const std::string& last);
/// Declares `type` and the keys of each type.
void declare_boundary(config::Section& section, BoundaryParameters& parameters);
void declare_rotation(config::Section& section, RotationParameters& rotation);
/// Declares the keys of heat in a patch.
void declare_heat_boundary(config::Section& section, BoundaryParameters& boundary);
/// Declares the section `heat` and its rules. Reads all other keys.
void declare_heat(config::Section& section, FluidParameters& parameters);

/// Time scheme of the pressure waves of a weakly compressible fluid.
enum class WaveScheme { none, three_level, trapezoidal };

/// Compressibility of a fluid. With `none`, it is only used to check that neglecting it was justified.
struct CompressibilityParameters {
  WaveScheme scheme = WaveScheme::three_level;
  std::optional<double> mean_time;       // [s], of the means at absorbing boundaries
  std::optional<double> speed_of_sound;  // [m/s]
  double upstream_volume = 0;            // [m^3], before the inlets, not in the mesh
  bool is_solved() const { return scheme != WaveScheme::none; }
};
void declare(config::Section& section, CompressibilityParameters& parameters);

struct Sound {
  double speed = 0;  ///< [m/s]
  std::string of;    ///< substance, for example "water"
};
/// Speed of sound from the keys, else from density [kg/m^3] and viscosity [Pa s] if they match a gas at 1 atm
/// or a liquid. Empty for a model fluid, such as one of 1 kg/m^3 and 1 Pa s.
std::optional<Sound> sound_of(const std::optional<CompressibilityParameters>& parameters, double density,
                              double viscosity);

/// Speed of sound of a weakly compressible fluid [m/s], else 0. Throws Error if it is unknown.
double solved_sound(const std::optional<CompressibilityParameters>& parameters, double density,
                    double viscosity);

enum class ViscousTreatment { automatic, explicit_, implicit };

/// Order of the operators along lines of hexahedra and quadrilaterals.
enum class FaceValues { second_order, fourth_order, automatic };

/// Source of the pressure level, and so of the volume, of a fluid without an outlet.
enum class VolumeLevelBy { nobody, structure };

enum class TurbulenceModel { smagorinsky, wale };

/// Large-eddy simulation; absent if there is no model.
struct TurbulenceParameters {
  TurbulenceModel model = TurbulenceModel::wale;
  std::optional<double> constant;  // absent means the usual one of the model
  double constant_of() const { return constant.value_or(model == TurbulenceModel::wale ? 0.325 : 0.17); }
};

/// Treatment of cells that the surface of an immersed body intersects.
enum class BodySurface { automatic, steps, cut };

/// A rigid body inside the mesh.
struct BodyParameters {
  config::ExpressionText level;                  // [m], below zero inside
  std::vector<config::ExpressionText> velocity;  // [m/s]; empty means at rest
  BodySurface surface = BodySurface::automatic;
};

/// Two walls that block the flow between them where they are closer than `opening`.
struct GapParameters {
  std::vector<std::string> between;
  double opening = 0;  // [m]
  /// Height of the seat, the second wall, along `direction` [m]; absent if not given.
  std::optional<config::ExpressionText> height;
  std::vector<double> direction;  // from the seat to the other wall; empty means z (y in 2-D)
};

/// Running means from a time on; absent if there are none.
struct StatisticsParameters {
  double start = 0;  // [s]
};

/// Force and moment coefficients of a group of walls.
struct CoefficientParameters {
  std::vector<std::string> patches;
  double speed = 1, area = 1, length = 1;  // [m/s], [m^2] (2-D: m of depth 1 m), [m]
  double pressure = 0;                     // [Pa], reference of Cp
  Vec3 drag = Vec3::UnitX(), lift = Vec3::UnitY(), axis = Vec3::UnitZ(), centre = Vec3::Zero();
};

/// Places where velocity and pressure are written at each output: a line or a plane.
struct SampleParameters {
  enum class Type { line, plane };
  Type type = Type::line;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  // [m]; of a plane: two corners, the third is `up`
  Vec3 up = Vec3::Zero();                       // [m]
  int points = 101, rows = 21;                  // along from-to; along from-up
};

/// Effective flow area between two patches.
struct FlowAreaParameters {
  std::string from, to;
};

/// Fields and series beyond velocity, pressure, forces and balance.
struct FluidOutputParameters {
  std::map<std::string, bool> gradient_fields;  // by their names, see output/derived.hpp
  bool energy_budget = false, walls = false, fluxes = false;
  bool viscosity = false;             // field of a viscosity law
  std::vector<std::string> surfaces;  // patches, or "all"
  std::map<std::string, CoefficientParameters> coefficients;
  std::map<std::string, FlowAreaParameters> flow_areas;
  std::map<std::string, SampleParameters> samples;
};

/// Transport of heat, see heat/heat.hpp; absent if the temperature is not computed.
struct HeatParameters {
  enum class Convection { central, bounded };
  double conductivity = 0;   // [W/(m K)]
  double specific_heat = 0;  // [J/(kg K)]
  Convection convection = Convection::central;
  double expansion = 0;                                  // [1/K]
  std::vector<double> gravity;                           // [m/s^2]; empty without buoyancy
  double reference_temperature = 293.15;                 // [K]
  config::ExpressionText initial_temperature{"293.15"};  // [K], of x, y, z
  std::optional<double> frozen_flow;                     // [s]
  bool is_buoyant() const { return expansion != 0 && !gravity.empty(); }
};

struct ProbeParameters {
  Vec3 point = Vec3::Zero();  // [m]
};

/// Properties of a fluid.
struct Properties {
  double rho = 0;    ///< density [kg/m^3]
  double mu = 0;     ///< dynamic viscosity [Pa s]; of a law the smallest, see State::excess for the rest
  double nu = 0;     ///< kinematic viscosity [m^2/s]
  double sound = 0;  ///< speed of sound [m/s]; 0 means incompressible
};

struct FluidParameters {
  std::string mesh;
  std::map<std::string, double> mesh_parameters;
  double mesh_scale = 1;
  int dimension = 3;
  double density = 0;    // [kg/m^3]
  double viscosity = 0;  // dynamic [Pa s]; not used if there is a law
  std::optional<ViscosityLaw> viscosity_law;
  std::map<std::string, BoundaryParameters> boundaries;
  std::optional<double> time_step;  // [s]; absent if it follows from the stability limit
  double safety_factor = 0.8;
  ViscousTreatment viscous = ViscousTreatment::automatic;
  /// Largest ratio of implicit to explicit sub-step; absent if unlimited.
  std::optional<double> implicit_stretch;
  /// Largest Courant number of a sub-step; absent if convection is explicit.
  std::optional<double> courant;
  double pressure_tolerance = 1e-6;
  std::vector<config::ExpressionText> initial_velocity;    // [m/s]; empty means at rest
  std::optional<config::ExpressionText> initial_pressure;  // [Pa]
  std::vector<config::ExpressionText> body_force;          // [m/s^2]; empty if there is none
  std::optional<TurbulenceParameters> turbulence;
  std::optional<StatisticsParameters> statistics;
  FluidOutputParameters output;
  std::map<std::string, BodyParameters> bodies;
  std::map<std::string, GapParameters> gaps;
  std::optional<fv::MotionParameters> motion;        // of the mesh; absent if it is at rest
  std::optional<RotationParameters> rotating_frame;  // frame of mesh and velocities; absent if it is inertial
  FaceValues face_values = FaceValues::second_order;
  VolumeLevelBy volume_level = VolumeLevelBy::nobody;
  std::optional<CompressibilityParameters> compressibility;  // absent if neglected, which the density checks
  std::map<std::string, ProbeParameters> probes;
  std::optional<HeatParameters> heat;
  bool is_compressible() const { return compressibility && compressibility->is_solved(); }
  Properties properties() const {
    const double mu = viscosity_law ? viscosity_law->smallest() : viscosity;
    return {density, mu, mu / density, solved_sound(compressibility, density, mu)};
  }
  /// Largest viscosity at a shear rate [1/s].
  double viscosity_at(double shear_rate) const {
    return viscosity_law ? (*viscosity_law)(shear_rate)*viscosity_law->factors().second : viscosity;
  }
};

/// Pairs of periodic patches. Throws Error if two patches do not name each other.
std::vector<std::array<std::string, 2>> periodic_patches(const FluidParameters& parameters);

void declare(config::Section& section, FluidParameters& parameters);
/// Rules for openings, and for what sets the pressure level. Reads all other keys.
void declare_levels(config::Section& section, const FluidParameters& parameters);
/// Declares the section `output`.
void declare_output(config::Section& section, FluidOutputParameters& parameters);

/// A field made from the velocity gradient g, g(i, j) = du_i/dx_j [1/s], of each cell. In 2-D, z has no part in g.
struct GradientField {
  const char *name, *unit;  ///< the name is a key of `output` that enables the field
  const char* meaning;
  bool is_vector;  ///< three components; in 2-D only the last one. Otherwise only the first.
  Vec3 (*value)(const Tensor3& g);
};
/// All such fields.
std::span<const GradientField> gradient_fields();

/// A place of a patch at which its expressions are looked at. Velocities along the face carry no volume through it.
struct PlaceOfPatch {
  Vec3 at, normal = Vec3::Ones();
};
/// Places of a patch, or of the mesh for an empty name.
using PlacesOfPatch = std::function<std::vector<PlaceOfPatch>(const std::string&)>;
/// Largest rate of what boundaries and motions prescribe until the time `end` [1/s].
double prescribed_rate(const FluidParameters& parameters, const PlacesOfPatch& places_of, double end,
                       double step);

/// Resolves `effects: auto` of a fluid: its dimension, laminar flow or LES, the viscous scheme, pressure
/// waves, and mesh motion. The speed is the largest one in boundaries, profiles and the initial state. The
/// Reynolds number uses the smallest side of the mesh's bounding box.
std::vector<diagnostics::EffectChoice> choose_effects(const FluidParameters& parameters,
                                                      const mesh::MeshFacts& mesh,
                                                      const diagnostics::CaseScene& scene);

}  // namespace couplet::fluid
