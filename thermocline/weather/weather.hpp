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
  double humidity = 0.5;        ///< relative [1]
  double pressure = 101325;     ///< of the air [Pa]
  double sun_height = 0;        ///< sine of the sun's height above the horizon [1]; 0 if unknown
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
  /// The clock of the simulation is `shift_hours` ahead of the file's. Throws Error if a day of the period is
  /// missing.
  Weather(const WeatherHours& record, const WeatherPeriod& period, int shift_hours = 0);

  Ambient at(double t) const;
  /// Mean air temperature of the whole record, also that of deep soil [K].
  double mean_temperature() const { return mean_temperature_; }
  /// Direct normal irradiation between two times [J/m^2].
  double irradiation(double from, double to) const;
  /// True if the position of the sun is known.
  bool has_site() const { return hours_.site.has_value(); }
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
  double sun_height(double t) const;
  double irradiation_since_start(double t) const;

  WeatherHours hours_;  ///< of the period only
  int first_day_, shift_hours_;
  double mean_temperature_;        ///< [K]
  std::vector<double> slope_;      ///< of the irradiance over each hour [W/m^2 per hour]
  std::vector<double> cumulated_;  ///< irradiation before each hour [J/m^2], one more than hours
};

enum class WeatherKind { constant, file, clear_sky, smooth_days };

/// Geographic position of a weather file that does not state it.
struct SiteParameters {
  double latitude = 0, longitude = 0;  ///< [deg], north and east positive
  double time_zone = 0;                ///< hours by which the file's clock is ahead of Greenwich
};
void declare(config::Section& section, SiteParameters& site);

/// Keys of the section `ambient`.
struct WeatherParameters {
  WeatherKind kind = WeatherKind::constant;
  std::string file;
  std::optional<SiteParameters> site;
  ClearSky sky;
  SmoothDays smooth;
  double shift_hours = 0;  ///< hours by which the clock of the simulation is ahead of the file's
  bool mean_days = false;
  std::string from = "01-01", to;  ///< dates MM-DD; empty for the whole year
  Ambient constant;
};
void declare(config::Section& section, WeatherParameters& parameters);

/// Reads or generates the weather. Throws Error.
std::unique_ptr<Weather> make_weather(const WeatherParameters& parameters,
                                      const std::filesystem::path& case_folder);

/// Returns the record with each hour's irradiance replaced by its mean over all days of the month, as in
/// tables of average days. Keeps the energy of every month.
WeatherHours with_mean_days(WeatherHours record);

/// Reasons to doubt the sun of a record, as sentences: irradiance with the sun below the horizon, or a clock far
/// from that of the longitude. Without a site: irradiance around midnight of the simulation's clock.
std::vector<std::string> doubts_about_sun(const WeatherHours& record, int shift_hours = 0);

}  // namespace couplet::thermocline
