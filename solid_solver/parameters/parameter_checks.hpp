// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Keys of the temperature: solved for, prescribed or received, and what follows from it.
void declare_heat(config::Section& section, SolidParameters& parameters);
/// Rules between the keys of a solid, each told at the key to change.
void check_together(config::Section& section, SolidParameters& parameters);
/// What finite strain cannot have.
void check_finite_strain(config::Section& section, SolidParameters& parameters);
/// What patches that move as rigid bodies cannot have.
void check_rigid_patches(config::Section& section, SolidParameters& parameters);
/// What buckling cannot have.
void check_buckling(config::Section& section, SolidParameters& parameters);
/// What the estimate of large strain cannot have.
void check_large_strain_estimate(config::Section& section, SolidParameters& parameters);
/// What quantities of interest cannot have.
void check_quantities(config::Section& section, SolidParameters& parameters);
/// What a body of revolution cannot have.
void check_axisymmetric(config::Section& section, SolidParameters& parameters);
/// Whether a condition pushes along the normal.
bool is_pressure(const SolidCondition& condition);
/// Whether a body of revolution can have a condition.
bool can_be_revolved(const SolidCondition& condition);
/// What a solid that meets a seat cannot have.
void check_contact(config::Section& section, SolidParameters& parameters);
/// What an orthotropic material cannot have.
void check_orthotropic(config::Section& section, SolidParameters& parameters);

}  // namespace couplet::solid
