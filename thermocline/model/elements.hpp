// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "common/app/program.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/choices.hpp"
#include "thermocline/model/parameters.hpp"

/// Elements of a tank as separate participants. The tank gives temperatures; they return the heat that they
/// take from it. Heat is that of a whole tank.
namespace couplet::thermocline {

/// Ground under a tank. At the face of the tank's bottom it
///   takes bottom-temperature K, bottom-coefficient W/(m^2 K)   of the lowest cell, t^{n+1}
///   takes tank-diameter m                                      inner; must equal the one here
///   gives bottom-heat W                                        into the ground, mean over the step
struct GroundElementParameters {
  double diameter = 0;             ///< [m]
  double initial_temperature = 0;  ///< of the tank's bottom; the ground starts in a steady state [K]
  GroundParameters ground;
  WeatherParameters ambient;
};
void declare(config::Section& section, GroundElementParameters& parameters);

/// Insulation around the wall. At faces along it, it
///   takes wall-temperature K   t^{n+1}
///   takes wall-diameter m      outer, of the lowest plate; must equal the one here within 2 %
///   takes wall-height m        of the rings; must equal the one here within 0.1 %
///   gives wall-heat W          into the insulation, mean over the step
struct BlanketElementParameters {
  double diameter = 0, height = 0;  ///< outer diameter of the wall, its height [m]
  int sections = 400;
  double initial_temperature = 0;  ///< of the wall; the insulation starts in a steady state [K]
  InsulationParameters insulation;
  WeatherParameters ambient;
};
void declare(config::Section& section, BlanketElementParameters& parameters);

/// Type of element that a `thermocline` computes, with its parameters.
struct ElementParameters {
  enum class Type { tank, ground, insulation } type = Type::tank;
  TankParameters tank;
  GroundElementParameters ground;
  BlanketElementParameters blanket;
};
void declare(config::Section& section, ElementParameters& parameters);

/// Adds the rows of flow.file to the parameters. Throws Error with file:line.
TankParameters with_files(TankParameters parameters, const std::filesystem::path& case_folder);
/// Missing or invalid weather and flow rows, and a sun of unknown position, for --check.
std::vector<app::ProblemOfKey> problems_of_files(const ElementParameters& parameters,
                                                 const std::filesystem::path& case_folder);

std::unique_ptr<coupling::Participant> make_element(const ElementParameters& parameters,
                                                    const app::ParticipantContext& context);

}  // namespace couplet::thermocline
