// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "thermocline/model/model.hpp"
#include "thermocline/model/parameters.hpp"
#include "thermocline/weather/weather.hpp"

/// Input that can be computed with but is hardly meant: what is asked about or refused before a run starts.
namespace couplet::thermocline {

/// Temperatures of the bed's start that look as if their unit was forgotten: colder than the fluid's lowest,
/// and within its limits if they were degC. One sentence, or empty.
std::string forgotten_unit_of_bed(const TankParameters& parameters);
/// Checks the temperatures of the flow likewise.
std::string forgotten_unit_of_flow(const TankParameters& parameters);

/// Sentences for the log about a tank in its first state: air and sun that nobody gave, a restart beyond the
/// cut-off, a flow that can never begin.
std::vector<std::string> questions(const TankParameters& parameters, const TankModel& model);

/// Prices that multiply nothing, as sentences.
std::vector<std::string> prices_for_nothing(const EconomicsParameters& prices, const Inventory& inventory,
                                            bool has_pump);

/// Empty, or why the seasons of the plant's calendar have no dates: constant weather has none.
std::string season_without_dates(const TankParameters& parameters);

/// Throws Error if the cover shall absorb the sun (`absorptance` > 0) and it is not known where the sun
/// stands. `key`: the full name of the key.
void require_sun(double absorptance, const Weather& weather, const std::string& key);

// Numbers that no tank has: a unit was forgotten or meant otherwise (10 for 10 mm). Each gives the sentence of a
// refusal with the number, or nothing.

std::string slip_in_tank(const BedParameters& bed, double diameter);
std::string slip_in_fluid(const FluidParameters& fluid, Advection advection);
std::string slip_in_filler(const Filler& filler);
std::string slip_in_bed(const BedParameters& bed, double diameter);
std::string slip_in_plates(const ShellParameters& shell, double diameter);
std::string slip_in_insulation(const InsulationParameters& insulation, double diameter);
std::string slip_in_ground(const GroundParameters& ground);
std::string slip_in_plant(const PlantParameters& plant);

}  // namespace couplet::thermocline
