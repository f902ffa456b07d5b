// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "thermocline/model/model.hpp"
#include "thermocline/weather/weather.hpp"

/// What is asked about before a run starts: input that can be computed with and is hardly meant.
namespace couplet::thermocline {

/// Temperatures of the bed's start that look as if their unit was forgotten: colder than the fluid's lowest,
/// and within its limits if they were degC. One sentence, or empty.
std::string forgotten_unit_of_bed(const TankParameters& parameters);
/// The same of what the flow brings.
std::string forgotten_unit_of_flow(const TankParameters& parameters);

/// Sentences for the log about a tank in its first state: air and sun that nobody gave, a restart beyond the
/// cut-off, a flow that can never begin.
std::vector<std::string> questions(const TankParameters& parameters, const TankModel& model);

/// At the end of a run: layers of capsules whose content neither melted nor froze anywhere, as sentences.
std::vector<std::string> never_melted(const TankModel& model);

/// Prices that multiply nothing, as sentences.
std::vector<std::string> prices_for_nothing(const EconomicsParameters& prices, const Inventory& inventory,
                                            bool has_pump);

/// Empty, or why the seasons of the plant's calendar have no dates: constant weather has none.
std::string season_without_dates(const TankParameters& parameters);

/// Throws Error if the cover shall absorb the sun (`absorptance` > 0) and it is not known where the sun
/// stands. `key`: the full name of the key.
void require_sun(double absorptance, const Weather& weather, const std::string& key);

}  // namespace couplet::thermocline
