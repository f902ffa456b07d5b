// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/diagnostics/diagnostics.hpp"
#include "fluid_solver/parameters/sound.hpp"

namespace couplet::fluid {

// Judges effects of turbulence and compressibility by numbers of a run.

/// Layers that the mesh does not resolve. `peclet`: largest cell Reynolds number; `yplus`: largest of walls, 0 without
/// walls; `reynolds`: by the largest speed and the hydraulic diameter.
diagnostics::EffectFinding unresolved_layers(int dimension, double peclet, double yplus, double reynolds);
/// Viscosity that a turbulence model adds, over the molecular one.
diagnostics::EffectFinding eddies(int dimension, double eddy_viscosity);
/// Walls under a turbulence model.
diagnostics::EffectFinding unresolved_walls(double yplus, double peclet);

/// `speed`: largest [m/s].
diagnostics::EffectFinding mach_number(double speed, const Sound& sound);
/// `density` [kg/m^3]; `range`: largest minus smallest pressure [Pa]; `speed`: largest [m/s].
diagnostics::EffectFinding change_of_density(bool is_compressible, double density, double range, double speed,
                                             const Sound& sound);
/// `stroke`: volume that moving walls sweep [m^3]; `pressure_volume`: pressure times the volume that it compresses [J];
/// fluctuations over the run.
diagnostics::EffectFinding compliance(double density, double stroke, double pressure_volume,
                                      const Sound& sound);
/// `rate`: of the motion of walls [1/s]; `size`: extent of the fluid [m].
diagnostics::EffectFinding wave_time(double rate, double size, const Sound& sound);

}  // namespace couplet::fluid
