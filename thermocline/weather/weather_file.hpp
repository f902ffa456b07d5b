// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace couplet::thermocline {

inline constexpr int hours_a_day = 24, days_a_year = 365;

/// Day of a 365-day year for "MM-DD", 0 for 01-01. Throws Error for an invalid date, including 02-29.
int day_of_year(const std::string& date);
/// Month of a day of the year, 0 to 11.
int month_of_day(int day);
/// Inverse of day_of_year; `day` may exceed a year.
std::string date_of_day(int day);

/// Hourly records of a site, whole days. `dni` is the mean over the hour; the states are at `state_offset`
/// after its start.
struct WeatherHours {
  std::string source;       ///< file or generator, for messages
  int first_day = 0;        ///< day of the year of the first record, 0 for 01-01
  double state_offset = 0;  ///< [s]
  /// Data for the sun's position; not every file has them.
  struct Site {
    double latitude = 0;     ///< [deg], north positive
    double solar_ahead = 0;  ///< solar time minus the file's clock [s]
  };
  std::optional<Site> site;
  std::vector<double> dni;          ///< direct normal irradiance [W/m^2]
  std::vector<double> temperature;  ///< of the air [degC]
  std::vector<double> wind;         ///< [m/s]
  std::vector<double> humidity;     ///< relative, 0 to 1; read and checked, but no balance needs it
  std::vector<double> pressure;     ///< [Pa]
  std::vector<std::string> warnings;
  std::vector<std::string> doubts;  ///< reasons to doubt the data
  int days() const { return static_cast<int>(dni.size()) / hours_a_day; }
};

/// Site from latitude and longitude [deg] and the hours by which the clock is ahead of Greenwich.
WeatherHours::Site site_of(double latitude, double longitude, double time_zone);

/// Reads a CSV file, optionally compressed, in the format of docs/formats.md. It has optional lines '#
/// latitude: ...', '# longitude: ...', '# time-zone: ...' and '# states-at: ...', a header with the columns
/// hour, dni_W_m2, T_degC, wind_m_s, rh_pct and p_Pa in any order, and one line per hour. Gaps of a few hours
/// are interpolated linearly with a warning. Throws Error with file:line for other errors, and for another
/// format with the command that converts it.
WeatherHours read_weather(const std::filesystem::path& file);

}  // namespace couplet::thermocline
