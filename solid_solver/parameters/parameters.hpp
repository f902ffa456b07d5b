// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"
#include "common/contact/contact.hpp"
#include "common/elasticity/elasticity.hpp"
#include "solid_solver/parameters/boundary_parameters.hpp"
#include "solid_solver/parameters/heat_parameters.hpp"
#include "solid_solver/parameters/interface_data.hpp"
#include "solid_solver/parameters/material_parameters.hpp"
#include "solid_solver/parameters/method_parameters.hpp"

namespace couplet::solid {

struct SolidProbe {
  Vec3 point = Vec3::Zero();
  std::vector<std::string> fields{"displacement"};
};

/// A number that the run is made for, and whose error it estimates at its end.
struct SolidQuantity {
  std::vector<double> point;  // [m]; empty: where the equivalent stress is largest
  std::string field = "displacement";
  std::string patch{};    // of a heat flow
  std::string component;  // "x" of a displacement, "xx" of a stress; of an equivalent stress none
};

/// Fields written at the output interval, and the energies.
struct SolidOutputParameters {
  bool deformed = true;
  bool stress = true;
  bool strain = false;
  bool principal_stress = false;
  bool point_stress = false;
  bool acceleration = false;
  bool energies = false;
  bool large_strain_estimate = false;
  bool spectrum = false;
  bool moments = false;
  Vec3 moment_centre = Vec3::Zero();  // [m]
  std::vector<std::string> surfaces;  // patches, or "all"
  int modes = 0;                      // frequencies and shapes that are asked for
  int buckling = 0;                   // load factors and shapes
};

void declare(config::Section& section, SolidProbe& probe);
void declare(config::Section& section, SolidQuantity& quantity, int dimension);
void declare(config::Section& section, SolidOutputParameters& output);

struct SolidParameters {
  enum class Analysis { static_, dynamic, thermal, buckling };  // buckling: static_ once it is read
  enum class Plane { strain, stress, axisymmetric };
  enum class Kinematics { small_strain, finite_strain };
  std::string mesh;
  std::map<std::string, double> mesh_parameters;
  double mesh_scale = 1;
  int dimension = 3;
  Plane plane = Plane::strain;
  Analysis analysis = Analysis::dynamic;
  bool seeks_buckling =
      false;  ///< 'analysis: buckling': a low load factor is its answer and no doubt about it
  Kinematics kinematics = Kinematics::small_strain;
  bool energy_momentum = false;  // finite strain: the stress of a step is one that conserves
  SolidMaterial material;
  std::optional<bool> material_given;  // `material` stands in the YAML
  ZoneMaterials materials;             // by zone of the mesh
  std::map<std::string, SolidBoundary> boundaries;
  std::map<std::string, PointLoad> point_loads;
  std::optional<contact::ContactParameters> contact;     // none: the solid meets nothing
  std::vector<config::ExpressionText> body_force;        // [N/m^3]; empty: none
  std::vector<double> gravity;                           // [m/s^2]; empty: none
  std::vector<config::ExpressionText> initial_velocity;  // [m/s]; empty: at rest
  time::TimeSchemeParameters time_scheme{.type = time::TimeScheme::automatic};  // see scheme_of()
  LoadStepping load_stepping;
  std::optional<SolidDamping> damping;
  std::optional<HeatParameters> heat;
  std::optional<config::ExpressionText> temperature;  // prescribed [K]; none: solved for or not known
  std::optional<InterfaceData> interface_data;        // none: forces only
  std::optional<ThermalExpansion> expansion;
  bool thermoelastic_coupling = false;
  std::optional<TimeStepControl> step_control;
  double stiffness_tolerance = 1e-3;  // change of elastic constants with the temperature that is let pass
  MethodParameters method;
  std::map<std::string, SolidProbe> probes;
  std::map<std::string, SolidQuantity> quantities;
  SolidOutputParameters output;
};

/// The keys of `participants.<name>` of a solid_solver.
void declare(config::Section& section, SolidParameters& parameters);

/// The material, or the materials in the order of their names, which is that of Mesh::cell_material.
std::vector<SolidMaterial> materials_of(const SolidParameters& parameters);

/// Of a body in space.
elastic::LameConstants lame_constants(double youngs_modulus, double poissons_ratio);
/// Lame's constants of a material (of an orthotropic one an isotropic mean); in plane stress lambda is the effective one of the plane problem.
elastic::LameConstants lame_constants(const SolidParameters& parameters, const SolidMaterial& material);
inline elastic::LameConstants lame_constants(const SolidParameters& parameters) {
  return lame_constants(parameters, parameters.material);
}

/// A body of revolution, x being the radius.
inline bool is_axisymmetric(const SolidParameters& p) {
  return p.dimension == 2 && p.plane == SolidParameters::Plane::axisymmetric;
}

/// Large strain by the thesis's own method.
inline bool is_updated_lagrangian(const SolidParameters& p) {
  return p.kinematics == SolidParameters::Kinematics::finite_strain &&
         p.analysis != SolidParameters::Analysis::thermal &&
         p.method.type == MethodParameters::Type::segregated;
}
inline bool has_finite_strain(const SolidParameters& p) {
  return p.kinematics == SolidParameters::Kinematics::finite_strain &&
         p.analysis != SolidParameters::Analysis::thermal;
}
/// What integrates a dynamic analysis in time. `auto` is generalised-alpha for a body of large strain that a partner loads: the trapezoidal rule
/// neither keeps the energy of a nonlinear law nor damps the highest modes, which a coupling excites. Else the trapezoidal rule.
time::TimeSchemeParameters scheme_of(const SolidParameters& parameters);
/// Some patch moves as a rigid body (remote-load with coupling: rigid).
bool has_rigid_patch(const SolidParameters& parameters);
/// Some material is orthotropic: all cells have an elastic matrix.
bool has_orthotropic(const SolidParameters& parameters);
/// From here up the volume strain of faces locks.
inline constexpr double nearly_incompressible = 0.4;
double largest_poissons_ratio(const SolidParameters& parameters);
/// Whose volume strain the symmetric gradient takes.
elastic::VolumeStrain volume_strain_of(const SolidParameters& parameters);
/// The symmetric gradient can have all of the scene's boundaries and the method that is asked for.
bool symmetric_suits(const SolidParameters& parameters);

/// For ElasticOperator: the constants of the cells.
elastic::ElasticBody elastic_body(const SolidParameters& parameters, const mesh::Mesh& mesh,
                                  const mesh::Geometry& geometry);
/// Throws Error where a symmetry plane does not mirror an orthotropic material into itself: it would be no plane of
/// symmetry. Collective.
void check_symmetry(const SolidParameters& parameters, const mesh::Mesh& mesh,
                    const elastic::ElasticOperator& rows);

}  // namespace couplet::solid
