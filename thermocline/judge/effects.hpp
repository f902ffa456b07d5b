// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "common/diagnostics/finding.hpp"
#include "thermocline/judge/elsewhere.hpp"

namespace couplet::thermocline {

/// Evidence of a run of a tank; the rest is told as sentences, see tank_effects.cpp. NaN: not seen.
struct Evidence {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double largest_biot = unknown;  ///< film d / (2 conductivity) of the grains at the largest flow
  double largest_mach = unknown;  ///< of a gas between the grains at the largest flow
  /// For `advection: implicit`: how far its largest step spreads a front that crosses the bed, over the bed's height.
  double implicit_spread = unknown, implicit_step = unknown;  ///< and a step that brings the limit [s]
  /// For a gas: by what share the mean specific heat between the coldest and the hottest fluid differs from the
  /// constant that the run counts with, and that mean [J/(kg K)].
  double capacity_error = unknown, mean_capacity = unknown;
  /// At the largest flow: the power of a pump or fan over the heat that it carries between the coldest and the hottest fluid,
  /// and the pressure loss [Pa].
  double pumping_share = unknown, pressure_loss = unknown;
  /// In a scene with `pump`, at the largest flow: that power [W] and that heat [W].
  double driving_power = unknown, carried_heat = unknown;
  /// Without mixing: how much colder fluid was than the fluid below it [K], at most, and that over the range of the run.
  double inversion = unknown, inverted_share = unknown;
  double share_of_yield = unknown;  ///< largest equivalent stress of the wall over its yield strength
  /// That number with what bending would add at the wall's faces; both as looked at every two hours.
  double share_as_rings = unknown, share_with_bending = unknown;
};

/// Judges the effects of a scene by the evidence of a run.
std::vector<diagnostics::Finding> effect_findings(const ElementParameters& scene, const Evidence& evidence);

}  // namespace couplet::thermocline
