// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thermocline/bed/packed_bed.hpp"
#include "thermocline/plant/flow.hpp"
#include "thermocline/plant/report.hpp"
#include "thermocline/wall/layers.hpp"
#include "thermocline/wall/mechanics.hpp"
#include "thermocline/wall/shell.hpp"
#include "thermocline/wall/surroundings.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

struct UllageSpace {
  double height = 0;          ///< between bed and roof [m]
  double gauge_pressure = 0;  ///< of the gas [Pa]
};

struct GroundLayer {
  std::string material = "soil";
  double thickness = 0;  ///< [m]
};
struct GroundParameters {
  std::vector<GroundLayer> layers;  ///< from the tank downward
  double cell = 0.05;               ///< largest cell height near the tank [m]
  double step = 900;                ///< time step of the ground [s]
};

/// Section that is present in the YAML file although all its keys have defaults.
struct Present {};

/// Elements of this tank that separate participants compute.
struct ElsewhereParameters {
  bool ground = false, insulation = false;
};

struct TankOutput {
  double monitor_interval = 0;  ///< [s]; 0 for each step
};

/// Keys of `participants.<name>`; each optional member is an effect.
struct TankParameters {
  double diameter = 0;       ///< inner [m]
  double exchange_step = 0;  ///< longest step between exchanges [s]; 0 means that of the simulation
  MediumInput fluid;
  FillerParameters filler;
  BedParameters bed;
  std::optional<ShellParameters> shell;
  std::optional<Present> mechanics;
  std::optional<ExternalWallParameters> external_wall;
  std::optional<InsulationParameters> insulation;
  std::optional<UllageSpace> ullage;
  std::optional<GroundParameters> ground;
  std::optional<ElsewhereParameters> elsewhere;
  std::optional<PumpParameters> pump;
  std::optional<Present> ambient_given;  ///< otherwise `ambient` contains defaults
  WeatherParameters ambient;
  FlowParameters flow;
  std::optional<ReportParameters> report;
  TankOutput output;
};
void declare(config::Section& section, GroundParameters& parameters);
void declare(config::Section& section, TankParameters& parameters);

}  // namespace couplet::thermocline
