// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "thermocline/model/parameters.hpp"

/// Numbers that no tank has: a unit was forgotten or meant otherwise (10 for 10 mm). Each gives the sentence of a
/// refusal with the number, or nothing.
namespace couplet::thermocline {

std::string slip_in_tank(const BedParameters& bed, double diameter);
std::string slip_in_fluid(const FluidParameters& fluid, Advection advection);
std::string slip_in_filler(const Filler& filler);
std::string slip_in_bed(const BedParameters& bed, double diameter);
std::string slip_in_plates(const ShellParameters& shell, double diameter);
std::string slip_in_insulation(const InsulationParameters& insulation, double diameter);
std::string slip_in_ground(const GroundParameters& ground);
std::string slip_in_plant(const PlantParameters& plant);

}  // namespace couplet::thermocline
