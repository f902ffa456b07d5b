// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "thermocline/model/model.hpp"
#include "thermocline/model/parameters.hpp"
#include "thermocline/weather/weather.hpp"

/// Valid but implausible input: questions or refusals before a run starts.
namespace couplet::thermocline {

/// Detects initial bed temperatures with a forgotten unit: below the fluid's lowest, but within its limits if
/// read as degC. Returns a sentence or nothing.
std::string forgotten_unit_of_bed(const TankParameters& parameters);
/// Checks the temperatures of the flow likewise.
std::string forgotten_unit_of_flow(const TankParameters& parameters);

/// Sentences for the log about a tank in its initial state: missing air and sun, a restart beyond the
/// cut-off, a flow that never starts.
std::vector<std::string> questions(const TankParameters& parameters, const TankModel& model);

/// Prices without a matching quantity, as sentences.
std::vector<std::string> prices_for_nothing(const EconomicsParameters& prices, const Inventory& inventory,
                                            bool has_pump);

/// Why the seasons of the plant's calendar have no dates; empty if they have. Constant weather has none.
std::string season_without_dates(const TankParameters& parameters);

/// Throws Error if the cover absorbs sunlight (`absorptance` > 0) but the sun's position is unknown. `key`:
/// full name of the key.
void require_sun(double absorptance, const Weather& weather, const std::string& key);

}  // namespace couplet::thermocline
