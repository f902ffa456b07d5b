// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Declares the keys of the temperature, solved for, prescribed or received, and of its effects.
void declare_heat(config::Section& section, SolidParameters& parameters);
/// Checks combinations of keys of a solid, and reports each at the key to change.
void check_together(config::Section& section, SolidParameters& parameters);
/// Rejects a temperature that is missing or given twice.
void check_heat(config::Section& section, SolidParameters& parameters);
/// Rejects settings that are incompatible with finite strain.
void check_finite_strain(config::Section& section, SolidParameters& parameters);
/// Rejects settings that are incompatible with patches that move as rigid bodies.
void check_rigid_patches(config::Section& section, SolidParameters& parameters);
/// Rejects settings that are incompatible with a buckling analysis.
void check_buckling(config::Section& section, SolidParameters& parameters);
/// Rejects settings that are incompatible with quantities of interest.
void check_quantities(config::Section& section, SolidParameters& parameters);
/// Rejects settings that are incompatible with a body of revolution.
void check_axisymmetric(config::Section& section, SolidParameters& parameters);
/// True if a condition acts along the normal.
bool is_pressure(const SolidCondition& condition);
/// True if a condition is possible in a body of revolution.
bool can_be_revolved(const SolidCondition& condition);
/// Rejects settings that are incompatible with steps along the load path.
void check_load_stepping(config::Section& section, SolidParameters& parameters);
/// Rejects settings that are incompatible with contact at a seat.
void check_contact(config::Section& section, SolidParameters& parameters);
/// Rejects settings that are incompatible with an orthotropic material.
void check_orthotropic(config::Section& section, SolidParameters& parameters);

}  // namespace couplet::solid
