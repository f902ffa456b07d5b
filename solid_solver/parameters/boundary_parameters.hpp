// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet::solid {

/// Loads given by their total, for patches of type force, remote-load, bearing-load and hydrostatic-pressure.
/// In 2-D, forces and moments are per meter of depth.
struct TotalLoad {
  std::vector<config::ExpressionText> force;  ///< [N], function of t, one per component; empty if none
  /// About `point` [N m], function of t: 3 components, in 2-D 1; empty if there is none.
  std::vector<config::ExpressionText> moment;
  Vec3 point = Vec3::Zero();     ///< remote-load: where the force acts [m]
  bool is_rigid = false;         ///< remote-load: the faces move as a rigid body
  double density = 0;            ///< hydrostatic-pressure: of the liquid [kg/m^3]
  std::vector<double> gravity;   ///< hydrostatic-pressure: [m/s^2]
  config::ExpressionText level;  ///< hydrostatic-pressure: height of the free surface [m], function of t
};

/// Force and moment at a point of the surface.
struct PointLoad : TotalLoad {
  double radius = 0;  ///< of the loaded faces [m]; 0 selects the nearest face
};

/// `dimension`: a reference, because the key of the case is read before the loads.
void declare_total_force(config::Section& section, TotalLoad& load, const int& dimension);
void declare_remote_load(config::Section& section, TotalLoad& load, const int& dimension);
void declare_bearing_load(config::Section& section, TotalLoad& load, const int& dimension);
void declare_hydrostatic_pressure(config::Section& section, TotalLoad& load, const int& dimension);
void declare(config::Section& section, PointLoad& load, const int& dimension);

/// Boundary condition on a patch or a part of it. Only the types named use the members below `type`.
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
  /// Displacement [m] of a fixed-displacement, traction [Pa], or displacement of a spring's far end [m]; one per
  /// component.
  std::vector<config::ExpressionText> value;
  /// fixed-displacement: the known components [m], instead of `value`.
  std::array<std::optional<config::ExpressionText>, 3> components;
  /// fixed-displacement by component, spring: additional traction [Pa], one per component; empty if none.
  std::vector<config::ExpressionText> traction;
  config::ExpressionText pressure;   ///< pressure: [Pa], positive into the solid
  Vec3 normal = Vec3::UnitZ();       ///< roller, soft and hard support: direction that is held
  config::ExpressionText along;      ///< roller: displacement along it [m]
  config::ExpressionText stiffness;  ///< spring: [N/m^3]
  bool along_normal = false;         ///< spring: resists the normal displacement only
  TotalLoad load;                    ///< force, remote-load, bearing-load, hydrostatic-pressure
};

/// Faces of a patch whose center fulfills a condition.
struct SolidPart : SolidCondition {
  config::ExpressionText where;
};

struct SolidBoundary : SolidCondition {
  std::vector<SolidPart> parts;  ///< the first match applies; other faces use the patch's own condition
};

/// True if only the force is prescribed.
bool is_load(const SolidCondition& condition);
/// True if the load comes from the coupler.
bool is_interface(const SolidCondition& condition);
/// True if the faces of a remote-load move as one rigid body.
bool is_rigid(const SolidCondition& condition);
bool is_symmetry_plane(const SolidCondition& condition);
/// True if the condition derives from no functional, so that the symmetric gradient cannot apply it.
bool has_no_energy(const SolidCondition& condition);

/// `dimension`: a reference, because the key of the case is read before the boundaries.
void declare(config::Section& section, SolidBoundary& boundary, const int& dimension);

}  // namespace couplet::solid
