// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::thermocline {

/// Hourly records of a site, whole days. `dni` is the mean over the hour; the states belong to the moment
/// `state_offset` after its start.
struct WeatherHours {
  std::string source;       ///< for messages: file or generator
  int first_day = 0;        ///< day of the year of the first record, 0 for 01-01
  double state_offset = 0;  ///< [s]
  /// Where the sun stands follows from these; not in every file.
  struct Site {
    double latitude = 0;     ///< [deg], north positive
    double solar_ahead = 0;  ///< of the file's clock [s]
  };
  std::optional<Site> site;
  std::vector<double> dni;          ///< direct normal irradiance [W/m^2]
  std::vector<double> temperature;  ///< of the air [degC]
  std::vector<double> wind;         ///< [m/s]
  std::vector<double> humidity;     ///< relative, 0 to 1
  std::vector<double> pressure;     ///< [Pa]
  /// Whole hours by which local standard time, of the longitude, is ahead of the file's clock, where that is known
  /// not to be local (PVGIS: UTC).
  int local_ahead = 0;
  std::vector<std::string> warnings;
  std::vector<std::string> doubts;  ///< why it may not be what was meant
  int days() const { return static_cast<int>(dni.size()) / 24; }
};

/// One column of a weather file: what it is called, what is believable.
struct WeatherQuantity {
  std::string_view name;  ///< in messages: "temperature [degC]"
  std::string_view head;  ///< in the CSV: "T_degC"
  double lowest, highest;
  std::vector<double> WeatherHours::*target;
  double factor;  ///< from the file's unit
};
extern const std::array<WeatherQuantity, 5> weather_quantities;

/// CSV: lines with '#' are comments; then a head with the columns hour (of the year, from 0), dni_W_m2 (mean
/// over that hour), T_degC, wind_m_s, rh_pct, p_Pa in any order (states at mid-hour); then a line an hour.
/// May be compressed (.gz). Values may be empty or nan. Gaps of at most longest_gap hours are closed by
/// straight lines with a warning; longer ones, unknown or missing columns, hours that do not follow one
/// another and values that cannot be true throw Error with file:line.
WeatherHours read_weather_csv(const std::filesystem::path& file);

/// EnergyPlus weather (EPW; eight header lines, 35 columns, hours 1 to 24, the irradiance of the hour that
/// ends then, states at that moment) [epw]. Its codes for missing values are treated as gaps.
WeatherHours read_weather_epw(const std::filesystem::path& file);

/// SAM CSV, the format of NREL's NSRDB: site in two lines, then Year,Month,Day,Hour,Minute,... with DNI, air
/// temperature, wind, humidity or dew point, pressure [mbar]; several records an hour are averaged.
WeatherHours read_weather_sam(const std::filesystem::path& file);

/// NREL's TMY3: site in one line, hours 01:00 to 24:00, the irradiance of the hour that ends then.
WeatherHours read_weather_tmy3(const std::filesystem::path& file);

/// The typical year of PVGIS as CSV, clock UTC, values of the moment: the mean of an hour is that of the straight
/// lines between them. The moment of the irradiance is that of the stamp, later by the file's "Irradiance Time Offset".
WeatherHours read_weather_pvgis(const std::filesystem::path& file);

/// By the file's first lines: EPW, PVGIS, TMY3, SAM or NSRDB, else the project's own CSV; ".gz" behind any is
/// decompressed.
WeatherHours read_weather(const std::filesystem::path& file);

/// The same record with each hour's irradiance replaced by the mean over that hour of all days of its month
/// (of the record): the sun as tables of average days give it. The energy of every month stays.
WeatherHours with_mean_days(WeatherHours record);

/// What speaks against the sun of a record with a site: irradiance while the sun is below the horizon, a clock far
/// from that of the longitude. Sentences.
std::vector<std::string> doubts_about_sun(const WeatherHours& record);

inline constexpr int longest_gap = 6;  // [h]

}  // namespace couplet::thermocline
