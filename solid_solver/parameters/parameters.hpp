// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"
#include "common/contact/contact.hpp"
#include "common/elasticity/elastic_kernel.hpp"
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

/// Quantity of interest, whose error the run estimates at its end.
struct SolidQuantity {
  std::vector<double> point;  // [m]; empty means where the equivalent stress is largest
  std::string field = "displacement";
  std::string patch{};    // of a heat flow
  std::string component;  // "x" of a displacement, "xx" of a stress; empty for an equivalent stress
};

/// Fields written at the output interval, and the energies.
struct SolidOutputParameters {
  bool stress = true;
  bool strain = false;
  bool point_stress = false;
  bool acceleration = false;
  bool energies = false;
  bool spectrum = false;
  bool moments = false;
  std::vector<std::string> surfaces;  // patches, or "all"
  int modes = 0;                      // number of frequencies and shapes
  int buckling = 0;                   // number of load factors and shapes
};

void declare(config::Section& section, SolidProbe& probe);
void declare(config::Section& section, SolidQuantity& quantity, int dimension);
void declare(config::Section& section, SolidOutputParameters& output);

struct SolidParameters {
  // After parsing modal is dynamic and buckling static_.
  enum class Analysis { static_, dynamic, thermal, modal, buckling };
  enum class Plane { strain, stress, axisymmetric };
  enum class TouchingFaces { refused, tie, apart };
  enum class Kinematics { small_strain, finite_strain };
  std::string mesh;
  std::map<std::string, double> mesh_parameters;
  double mesh_scale = 1;
  TouchingFaces touching_faces = TouchingFaces::refused;
  int dimension = 3;
  Plane plane = Plane::strain;
  Analysis analysis = Analysis::dynamic;
  bool seeks_buckling =
      false;  ///< 'analysis: buckling': a low load factor is its answer and no doubt about it
  Kinematics kinematics = Kinematics::small_strain;
  bool energy_momentum = false;  // finite strain: use the conserving stress within a step
  SolidMaterial material;
  std::optional<bool> material_given;  // `material` is present in the YAML file
  ZoneMaterials materials;             // by zone of the mesh
  std::map<std::string, SolidBoundary> boundaries;
  std::map<std::string, PointLoad> point_loads;
  std::optional<contact::ContactParameters> contact;     // absent if the solid touches nothing
  std::vector<config::ExpressionText> body_force;        // [N/m^3]; empty if none
  std::vector<double> gravity;                           // [m/s^2]; empty if none
  std::vector<config::ExpressionText> initial_velocity;  // [m/s]; empty means at rest
  time::TimeSchemeParameters time_scheme{.type = time::TimeScheme::automatic};  // see scheme_of()
  LoadStepping load_stepping;
  std::optional<SolidDamping> damping;
  std::optional<HeatParameters> heat;
  std::optional<config::ExpressionText> temperature;  // prescribed [K]; absent if solved for or unknown
  std::optional<InterfaceData> interface_data;        // absent means forces only
  std::optional<ThermalExpansion> expansion;
  bool thermoelastic_coupling = false;
  std::optional<TimeStepControl> step_control;
  MethodParameters method;
  std::map<std::string, SolidProbe> probes;
  std::map<std::string, SolidQuantity> quantities;
  SolidOutputParameters output;
};

/// Declares the keys of `participants.<name>` of a solid_solver.
void declare(config::Section& section, SolidParameters& parameters);

/// The material, or the materials in the order of their names, which is that of Mesh::cell_material.
std::vector<SolidMaterial> materials_of(const SolidParameters& parameters);

/// Lame constants in 3-D.
elastic::LameConstants lame_constants(double youngs_modulus, double poissons_ratio);
/// Lame constants of a material (isotropic mean if orthotropic); in plane stress lambda is the effective one.
elastic::LameConstants lame_constants(const SolidParameters& parameters, const SolidMaterial& material);
inline elastic::LameConstants lame_constants(const SolidParameters& parameters) {
  return lame_constants(parameters, parameters.material);
}

/// True for a body of revolution; x is the radius.
inline bool is_axisymmetric(const SolidParameters& p) {
  return p.dimension == 2 && p.plane == SolidParameters::Plane::axisymmetric;
}

inline bool is_plane_stress(const SolidParameters& p) {
  return p.dimension == 2 && p.plane == SolidParameters::Plane::stress;
}

/// Tests all conditions, including those of parts of patches.
template <class Test>
bool any_condition(const SolidParameters& p, const Test& test) {
  return std::ranges::any_of(p.boundaries, [&](const auto& entry) {
    return test(entry.second) || std::ranges::any_of(entry.second.parts, test);
  });
}

/// True for large strain by the method of the thesis.
inline bool is_updated_lagrangian(const SolidParameters& p) {
  return p.kinematics == SolidParameters::Kinematics::finite_strain &&
         p.analysis != SolidParameters::Analysis::thermal &&
         p.method.type == MethodParameters::Type::segregated;
}
inline bool has_finite_strain(const SolidParameters& p) {
  return p.kinematics == SolidParameters::Kinematics::finite_strain &&
         p.analysis != SolidParameters::Analysis::thermal;
}
/// Time scheme of a dynamic analysis. `auto` is generalized-alpha at large strain with loads from a partner:
/// there the trapezoidal rule neither conserves energy nor damps the highest modes. Else it is that rule.
time::TimeSchemeParameters scheme_of(const SolidParameters& parameters);
/// True if some patch moves as a rigid body (remote-load with coupling: rigid).
bool has_rigid_patch(const SolidParameters& parameters);
/// True if some material is orthotropic; then all cells have an elastic matrix.
bool has_orthotropic(const SolidParameters& parameters);
/// Poisson's ratio above which the volume strain of faces locks.
inline constexpr double nearly_incompressible = 0.4;
double largest_poissons_ratio(const SolidParameters& parameters);
/// Volume strain used by the symmetric gradient.
elastic::VolumeStrain volume_strain_of(const SolidParameters& parameters);
/// True if the symmetric gradient supports all boundaries and the requested method.
bool symmetric_suits(const SolidParameters& parameters);
/// Requested face gradient. `automatic` is the symmetric one, which neither locks nor lets motion grow, or the
/// thesis's where symmetric_suits() is false.
elastic::FaceGradientScheme face_gradient_scheme(const SolidParameters& parameters);

/// Elastic constants of the cells for ElasticOperator.
elastic::ElasticBody elastic_body(const SolidParameters& parameters, const mesh::Mesh& mesh,
                                  const mesh::Geometry& geometry);
/// Throws Error if a symmetry plane does not map an orthotropic material onto itself, because the solution
/// would not be symmetric. Collective.
void check_symmetry(const SolidParameters& parameters, const mesh::Mesh& mesh,
                    const elastic::ElasticOperator& rows);

}  // namespace couplet::solid
