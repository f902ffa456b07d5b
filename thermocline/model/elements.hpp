// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "common/app/program.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/effects.hpp"
#include "thermocline/model/parameters.hpp"

/// Elements of a tank as participants of their own: the tank gives temperatures, they give the heat back that
/// they take from it. Heat is that of a whole tank.
namespace couplet::thermocline {

/// The ground under a tank. At the face of the tank's bottom
///   takes bottom-temperature K, bottom-coefficient W/(m^2 K)   of the lowest cell, t^{n+1}
///   takes tank-diameter m                                      inner; another one here is refused
///   gives bottom-heat W                                        into the ground, mean over the step
struct GroundElementParameters {
  double diameter = 0;             ///< [m]
  double initial_temperature = 0;  ///< of the tank's bottom at the start: the ground starts steady [K]
  GroundParameters ground;
  WeatherParameters ambient;
};
void declare(config::Section& section, GroundElementParameters& parameters);

/// The blanket around the wall. At faces along it
///   takes wall-temperature K   t^{n+1}
///   takes wall-diameter m      outer, of the lowest plate; another one here (beyond 2 %) is refused
///   takes wall-height m        of the rings; another one here (beyond 0.1 %) is refused
///   gives wall-heat W          into the blanket, mean over the step
struct BlanketElementParameters {
  double diameter = 0, height = 0;  ///< outer diameter of the wall, its height [m]
  int sections = 400;
  double initial_temperature = 0;  ///< of the wall: the blanket starts steady [K]
  InsulationParameters insulation;
  WeatherParameters ambient;
};
void declare(config::Section& section, BlanketElementParameters& parameters);

/// Element that one `thermocline` computes, with its parameters.
struct ElementParameters {
  enum class Type { tank, ground, insulation } type = Type::tank;
  TankParameters tank;
  GroundElementParameters ground;
  BlanketElementParameters blanket;
};
void declare(config::Section& section, ElementParameters& parameters);
/// The effects that a tank can simulate, for --explain and docs/effects.md.
std::span<const diagnostics::EffectCard<ElementParameters>> effect_cards();

/// The parameters with the rows of flow.file. Throws Error with file:line.
TankParameters with_files(TankParameters parameters, const std::filesystem::path& case_folder);
/// For --check: weather and rows of flows that are missing or broken, a sun that nobody can place.
std::vector<app::ProblemOfKey> problems_of_files(const ElementParameters& parameters,
                                                 const std::filesystem::path& case_folder);

std::unique_ptr<coupling::Participant> make_element(const ElementParameters& parameters,
                                                    const app::ParticipantContext& context);

}  // namespace couplet::thermocline
