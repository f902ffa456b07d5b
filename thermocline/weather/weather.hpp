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

/// The weather at one instant.
struct Ambient {
  double dni = 0;               ///< direct normal irradiance [W/m^2]
  double temperature = 293.15;  ///< of the air [K]
  double wind = 0;              ///< [m/s]
  double humidity = 0.5;        ///< relative [1]
  double pressure = 101325;     ///< of the air [Pa]
  double sun_height = 0;        ///< sine of the sun's height above the horizon [1]; 0 where it is not known
};

/// Which days of the weather are lived through: from the day `from`, where t = 0 at 00:00, to the end of the
/// day `to`, then `from` again. Days of the year, 0 for 01-01; `from` may lie after `to` (a winter). Without
/// `to`: the whole file.
struct WeatherPeriod {
  int from = 0;
  std::optional<int> to;
};

/// Hourly weather as functions of time. States are straight lines between the hourly moments, also where the
/// period begins again. The irradiance is a straight line within each hour, of the hour's mean and a slope
/// limited so that no value leaves the range of the neighboring hours (monotonized central differences
/// [vanleer1977]): the energy of every hour is that of the file.
class Weather {
 public:
  /// The simulation's clock is `shift_hours` ahead of the file's. Throws Error if a day of the period is not
  /// in the record.
  Weather(const WeatherHours& record, const WeatherPeriod& period, int shift_hours = 0);

  Ambient at(double t) const;
  double mean_temperature() const {
    return mean_temperature_;
  }  ///< air of the whole record, which deep soil has [K]
  /// Direct normal irradiation between two times [J/m^2].
  double irradiation(double from, double to) const;
  /// It is known where the sun stands.
  bool has_site() const { return hours_.site.has_value(); }
  const std::string& source() const { return hours_.source; }
  /// Gaps that were filled in the record, with file:line.
  const std::vector<std::string>& warnings() const { return hours_.warnings; }
  /// Why it may not be what was meant.
  const std::vector<std::string>& doubts() const { return hours_.doubts; }
  /// Date of the day in which t lies, as MM-DD.
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

/// Where on earth a weather file belongs, for files that do not say it.
struct SiteParameters {
  double latitude = 0, longitude = 0;  ///< [deg], north and east positive
  double time_zone = 0;                ///< hours that the file's clock is ahead of Greenwich
};
void declare(config::Section& section, SiteParameters& site);

/// Keys of the section `ambient`.
struct WeatherParameters {
  WeatherKind kind = WeatherKind::constant;
  std::string file;
  std::optional<SiteParameters> site;
  ClearSky sky;
  SmoothDays smooth;
  double shift_hours = 0;  ///< by which the clock of the simulation is ahead of that of the file
  bool mean_days = false;
  std::string from = "01-01", to;  ///< dates MM-DD; empty: the whole year
  Ambient constant;
};
void declare(config::Section& section, WeatherParameters& parameters);

/// Reads or makes it. Throws Error.
std::unique_ptr<Weather> make_weather(const WeatherParameters& parameters,
                                      const std::filesystem::path& case_folder);

/// Returns the record with each hour's irradiance replaced by the mean over that hour of all days of its month
/// (of the record), as tables of average days give it. The energy of every month stays.
WeatherHours with_mean_days(WeatherHours record);

/// Reasons to doubt the sun of a record with a site: irradiance while the sun is below the horizon, a clock far
/// from that of the longitude. Sentences.
std::vector<std::string> doubts_about_sun(const WeatherHours& record);

}  // namespace couplet::thermocline
