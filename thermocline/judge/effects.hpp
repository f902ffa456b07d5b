// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "common/log/finding.hpp"
#include "thermocline/judge/elsewhere.hpp"

namespace couplet::thermocline {

/// What a run of a tank has seen; the rest is told as sentences, see tank_effects.cpp. NaN: not seen.
struct Evidence {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double largest_biot = unknown;  ///< film d / (2 conductivity) of the grains at the largest flow
  double largest_mach = unknown;  ///< of a gas between the grains at the largest flow
  /// Of `advection: implicit`: what its largest step spreads a front that crosses the bed by, over the bed's height.
  double implicit_spread = unknown, implicit_step = unknown;  ///< and a step that brings the limit [s]
  /// Of a gas: by what share the mean specific heat between the coldest and the hottest fluid differs from the
  /// constant that the run counts with, and that mean [J/(kg K)].
  double capacity_error = unknown, mean_capacity = unknown;
  /// Of the largest flow: the power of a pump or fan over the heat that it carries between the coldest and the hottest fluid,
  /// and the pressure loss [Pa].
  double pumping_share = unknown, pressure_loss = unknown;
  /// Of a scene with `pump`, for the largest flow: that power [W] and that heat [W].
  double driving_power = unknown, carried_heat = unknown;
  /// Without mixing: how much colder fluid was than the fluid below it [K], at most, and that over the range of the run.
  double inversion = unknown, inverted_share = unknown;
  double share_of_yield = unknown;  ///< largest equivalent stress of the wall over its yield strength
  /// The same with what bending would add at the wall's faces; both as looked at every two hours.
  double share_as_rings = unknown, share_with_bending = unknown;
};

/// What the evidence of a run says about the effects of its scene.
std::vector<log::Finding> effect_findings(const ElementParameters& scene, const Evidence& evidence);

}  // namespace couplet::thermocline
