// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "common/effects/card.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// What the cards look at: the parameters, and what the job around the fluid decides.
struct FluidScene {
  FluidParameters parameters;
  bool moving_mesh = false;  ///< the job has a mesh mover
  bool coupled = false;
};

/// What a run has seen. NaN: not seen.
struct FluidEvidence {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double largest_peclet = unknown;  ///< cell Reynolds number
  double largest_yplus = unknown;   ///< of walls; 0 without walls
  double largest_speed = unknown;   ///< [m/s]
  double width = unknown;           ///< hydraulic diameter, 4 volumes over the area of the walls [m]
  double pressure_range = unknown;  ///< largest minus smallest pressure [Pa]
  /// Of walls that move: fluctuation (root mean square) of the volume that they sweep [m^3] and of pressure times volume [J],
  /// rate of their motion [1/s], and extent of the fluid [m].
  double stroke = unknown, pressure_volume = unknown, wall_rate = unknown, size = unknown;
  double energy_excess = unknown;  ///< kinetic energy that no work explains, of that of late (EnergyGuard)
  /// Of an interface on a mesh that stands still: largest displacement in heights of the cell there.
  double wall_displacement = unknown;
  double through_walls =
      unknown;  ///< largest flow through a moving wall of a resting mesh over its speed and area
  double eddy_viscosity = unknown;  ///< largest, over the molecular viscosity
  double blocked_cells = unknown;   ///< share of all cells that gaps block
};

using FluidCard = effects::EffectCard<FluidScene, FluidEvidence>;
std::span<const FluidCard> fluid_effect_cards();

}  // namespace couplet::fluid
