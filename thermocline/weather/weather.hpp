// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "thermocline/weather/made_days.hpp"

namespace couplet::thermocline {

/// Weather at one time.
struct Ambient {
  double dni = 0;               ///< direct normal irradiance [W/m^2]
  double temperature = 293.15;  ///< of the air [K]
  double wind = 0;              ///< [m/s]
  double pressure = 101325;     ///< of the air [Pa]
};

/// Period of the weather in use: from the day `from` (t = 0 at 00:00) to the end of the day `to`, then
/// repeated. Days of the year, 0 for 01-01; `from` may be after `to` (a winter). Without `to`, the whole
/// file.
struct WeatherPeriod {
  int from = 0;
  std::optional<int> to;
};

/// Hourly weather as functions of time. States are linear between hourly values, also where the period
/// repeats. The irradiance is linear within each hour, with the hour's mean and a slope limited to the range
/// of the adjacent hours (monotonized central differences [vanleer1977]), so the energy of every hour is
/// exact.
class Weather {
 public:
  /// Throws Error if a day of the period is missing.
  Weather(const WeatherHours& record, const WeatherPeriod& period);

  Ambient at(double t) const;
  /// Mean air temperature of the whole record, also that of deep soil [K].
  double mean_temperature() const { return mean_temperature_; }
  /// Direct normal irradiation between two times [J/m^2].
  double irradiation(double from, double to) const;
  const std::string& source() const { return hours_.source; }
  /// Gaps filled in the record, with file:line.
  const std::vector<std::string>& warnings() const { return hours_.warnings; }
  /// Reasons to doubt the data.
  const std::vector<std::string>& doubts() const { return hours_.doubts; }
  /// Date of the day that contains t, as MM-DD.
  std::string date(double t) const;

  int first_day() const { return first_day_; }                                ///< of the year, 0 for 01-01
  double period_length() const { return 3600. * double(hours_.dni.size()); }  ///< [s]

 private:
  double state(const std::vector<double>& values, double t) const;
  double wrapped(double t) const;
  double irradiation_since_start(double t) const;

  WeatherHours hours_;  ///< of the period only
  int first_day_;
  double mean_temperature_;        ///< [K]
  std::vector<double> slope_;      ///< of the irradiance over each hour [W/m^2 per hour]
  std::vector<double> cumulated_;  ///< irradiation before each hour [J/m^2], one more than hours
};

enum class WeatherKind { constant, file, clear_sky, smooth_days };

/// Keys of the section `ambient`.
struct WeatherParameters {
  WeatherKind kind = WeatherKind::constant;
  std::string file;
  ClearSky sky;
  SmoothDays smooth;
  std::string from = "01-01", to;  ///< dates MM-DD; empty for the whole year
  Ambient constant;
};
void declare(config::Section& section, WeatherParameters& parameters);

/// Reads or generates the weather. Throws Error.
std::unique_ptr<Weather> make_weather(const WeatherParameters& parameters,
                                      const std::filesystem::path& case_folder);

/// Reasons to doubt the sun of a record, as sentences: irradiance with the sun below the horizon, or a clock far
/// from that of the longitude. Without a site: irradiance around midnight of the clock.
std::vector<std::string> check_sun(const WeatherHours& record);

}  // namespace couplet::thermocline
