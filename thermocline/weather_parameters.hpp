// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/config/section.hpp"
#include "thermocline/clear_sky.hpp"
#include "thermocline/weather.hpp"

namespace couplet::thermocline {

enum class WeatherKind { constant, file, clear_sky };

/// What the section `weather` of the YAML says.
struct WeatherParameters {
  WeatherKind kind = WeatherKind::constant;
  std::string file;
  ClearSky sky;
  int shift_hours = 0;
  bool mean_days = false;
  std::string from = "01-01", to;  ///< dates MM-DD; empty: the whole year
  Ambient constant;
};
void declare(config::Section& section, WeatherParameters& parameters);

/// Reads or makes it. Throws Error.
std::unique_ptr<Weather> make_weather(const WeatherParameters& parameters,
                                      const std::filesystem::path& case_folder);

}  // namespace couplet::thermocline
