// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/config/section.hpp"
#include "thermocline/weather/clear_sky.hpp"
#include "thermocline/weather/smooth_days.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

enum class WeatherKind { constant, file, clear_sky, smooth_days };

/// Where on earth a weather file belongs, for files that do not say it.
struct SiteParameters {
  double latitude = 0, longitude = 0;  ///< [deg], north and east positive
  double time_zone = 0;                ///< hours that the file's clock is ahead of Greenwich
};
void declare(config::Section& section, SiteParameters& site);

/// What the section `weather` of the YAML says.
struct WeatherParameters {
  WeatherKind kind = WeatherKind::constant;
  std::string file;
  std::optional<SiteParameters> site;
  ClearSky sky;
  SmoothDays smooth;
  std::optional<double>
      shift_hours;  ///< absent: 0, or to local standard time where the file has another clock
  bool mean_days = false;
  std::string from = "01-01", to;  ///< dates MM-DD; empty: the whole year
  Ambient constant;
};
void declare(config::Section& section, WeatherParameters& parameters);

/// Reads or makes it. Throws Error.
std::unique_ptr<Weather> make_weather(const WeatherParameters& parameters,
                                      const std::filesystem::path& case_folder);

}  // namespace couplet::thermocline
