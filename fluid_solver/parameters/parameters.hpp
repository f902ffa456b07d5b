// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/prescribed_motion.hpp"
#include "fluid_solver/parameters/condition.hpp"
#include "fluid_solver/parameters/sound.hpp"

namespace couplet::fluid {

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
  bool vorticity = false, q_criterion = false, energy_budget = false, walls = false, fluxes = false;
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
