// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet::solid {

/// Loads by their total: of the patches of type force, remote-load, bearing-load and hydrostatic-pressure. In 2-D forces and
/// moments are those of one metre of depth.
struct TotalLoad {
  std::vector<config::ExpressionText> force;  ///< [N], of t, one a component; empty: none
  std::vector<config::ExpressionText>
      moment;                    ///< about `point` [N m], of t: 3 components, in 2-D 1; empty: none
  Vec3 point = Vec3::Zero();     ///< remote-load: where the force acts [m]
  bool is_rigid = false;         ///< remote-load: the faces move as a rigid body
  double density = 0;            ///< hydrostatic-pressure: of the liquid [kg/m^3]
  std::vector<double> gravity;   ///< hydrostatic-pressure: [m/s^2]
  config::ExpressionText level;  ///< hydrostatic-pressure: height of the free surface [m], of t
};

/// A force and a moment at a point of the surface.
struct PointLoad : TotalLoad {
  double radius = 0;  ///< of the faces that take it [m]; 0: the nearest one does
};

/// `dimension`: of the scene; read before the loads, so it is a reference.
void declare_total_force(config::Section& section, TotalLoad& load, const int& dimension);
void declare_remote_load(config::Section& section, TotalLoad& load, const int& dimension);
void declare_bearing_load(config::Section& section, TotalLoad& load, const int& dimension);
void declare_hydrostatic_pressure(config::Section& section, TotalLoad& load, const int& dimension);
void declare(config::Section& section, PointLoad& load, const int& dimension);

/// What happens on a patch or a part of it. The members below `type` are used by the types that name them.
struct SolidCondition {
  enum class Type {
    fixed_displacement,
    traction,
    pressure,
    force,
    remote_load,
    bearing_load,
    hydrostatic_pressure,
    symmetry,
    frictionless,
    roller,
    soft_support,
    hard_support,
    spring,
    zero_normal_gradient,
    free,
    interface_
  };
  Type type = Type::free;
  /// fixed-displacement: displacement [m]; traction: [Pa]; spring: displacement of its far end [m]; one a
  /// component.
  std::vector<config::ExpressionText> value;
  /// fixed-displacement: the components that are known, in place of `value` [m].
  std::array<std::optional<config::ExpressionText>, 3> components;
  /// fixed-displacement by component, spring: force per area beside it [Pa], one a component; empty: none.
  std::vector<config::ExpressionText> traction;
  config::ExpressionText pressure;   ///< pressure: [Pa], pushes into the solid
  Vec3 normal = Vec3::UnitZ();       ///< roller, soft and hard support: the direction that is held
  config::ExpressionText along;      ///< roller: displacement along it [m]
  config::ExpressionText stiffness;  ///< spring: [N/m^3]
  bool along_normal = false;         ///< spring: resists the normal displacement only
  TotalLoad load;                    ///< force, remote-load, bearing-load, hydrostatic-pressure
};

/// The faces of a patch whose centre fulfils a condition.
struct SolidPart : SolidCondition {
  config::ExpressionText where;
};

struct SolidBoundary : SolidCondition {
  std::vector<SolidPart> parts;  ///< the first one that selects a face counts; faces of none: the patch's own
};

/// Knows no more than the force there.
bool is_load(const SolidCondition& condition);
/// The load comes from the coupler.
bool is_interface(const SolidCondition& condition);
/// The faces of a remote-load move as one rigid body.
bool is_rigid(const SolidCondition& condition);
bool is_symmetry_plane(const SolidCondition& condition);
/// No functional has it as its condition, so that the symmetric gradient cannot have it.
bool has_no_energy(const SolidCondition& condition);

/// `dimension`: of the scene; read before the boundaries, so it is a reference.
void declare(config::Section& section, SolidBoundary& boundary, const int& dimension);

}  // namespace couplet::solid
