// SPDX-License-Identifier: Apache-2.0
// Keys that several conditions read.
#pragma once

#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {

void declare_velocity(config::Section& section, BoundaryParameters& parameters);
void declare_ramp(config::Section& section, BoundaryParameters& parameters);
/// Velocity from a file, and a rotation besides.
void declare_table_and_rotation(config::Section& section, BoundaryParameters& parameters);
void declare_rotation(config::Section& section, RotationParameters& rotation);
void declare_absorbing(config::Section& section, BoundaryParameters& parameters);

}  // namespace couplet::fluid
