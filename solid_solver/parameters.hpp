// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/elasticity.hpp"

namespace couplet {

/// What happens on one patch. `value` and `pressure` are used by the types that have them.
struct SolidBoundary {
  enum class Type { fixed_displacement, traction, pressure, symmetry, free, interface_ };
  Type type = Type::free;
  std::vector<config::ExpressionText> value;  // displacement [m] or traction [Pa], one a component
  config::ExpressionText pressure;            // [Pa], pushes into the solid
};

struct SolidMaterial {
  double density = 0;         // [kg/m^3]
  double youngs_modulus = 0;  // [Pa]
  double poissons_ratio = 0;
};

/// Rayleigh damping C = mass M + stiffness K, thesis (2.79).
struct SolidDamping {
  double mass = 0;       // [1/s]
  double stiffness = 0;  // [s]
};

struct SolidLinearSolver {
  enum class Method { automatic, direct, bicgstab_ilu, gmres_multigrid };
  Method method = Method::automatic;
  double relative_tolerance = 1e-10;
  int max_iterations = 2000;
};

struct SolidProbe {
  Vec3 point = Vec3::Zero();
};

struct SolidParameters {
  enum class Analysis { static_, dynamic };
  enum class Plane { strain, stress };
  std::string mesh;
  int dimension = 3;
  Plane plane = Plane::strain;
  Analysis analysis = Analysis::dynamic;
  SolidMaterial material;
  std::map<std::string, SolidBoundary> boundaries;
  std::vector<config::ExpressionText> body_force;        // [N/m^3]; empty: none
  std::vector<double> gravity;                           // [m/s^2]; empty: none
  std::vector<config::ExpressionText> initial_velocity;  // [m/s]; empty: at rest
  std::optional<SolidDamping> damping;
  SolidLinearSolver linear_solver;
  std::map<std::string, SolidProbe> probes;
  bool output_deformed = true;
  bool output_stress = true;
};

/// The keys of `participants.<name>` of a solid_solver.
void declare(config::Section& section, SolidParameters& parameters);

/// Lame's constants; in plane stress lambda is the effective one of the plane problem.
LameConstants lame_constants(const SolidParameters& parameters);

}  // namespace couplet
