// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "thermocline/weather/weather_file.hpp"

/// Years without a weather file: cloudless days, and days of a given energy and form.
namespace couplet::thermocline {

/// A year of cloudless days: all a new site needs is its latitude.
struct ClearSky {
  double latitude = 0;      ///< [deg], north positive
  double altitude = 0;      ///< above the sea [m], below 2500
  double coldest = 285.15;  ///< daily minimum of the air [K]
  double warmest = 301.15;  ///< daily maximum, reached at 15:00 [K]
  double wind = 2;          ///< [m/s]
  double humidity = 0.5;    ///< relative
};

/// Sine of the height of the sun at solar time `hour` (12 is noon) of `day` (0 for 01-01); negative at night.
/// Latitude in degrees [duffie2013, equation 1.6.5].
double sine_of_sun_height(double latitude, int day, double hour);

/// Direct normal irradiance [W/m^2] at solar time `hour` of `day`. Transmittance of the
/// cloudless standard atmosphere with 23 km visibility a0 + a1 exp(-k / cos(zenith)) [hottel1976],
/// extraterrestrial irradiance and declination [duffie2013, equations 1.4.1a and 1.6.1a].
double clear_sky_irradiance(const ClearSky& site, int day, double hour);

/// The year, hour by hour: means of the irradiance over each hour, air temperature as a sine of one day,
/// pressure of the standard atmosphere at this altitude. The clock shows solar time.
WeatherHours clear_sky_year(const ClearSky& site);

/// Cloudless days of a given energy and form: what is left of a year when only its monthly sums are known. On
/// a day of length T (from latitude and declination, times `length`) the direct normal irradiance is
///   DNI(t) = A (1 - |2 (t - noon)/T|^n)^p,   |t - noon| < T/2,
/// with A such that every day of a month has the month's mean daily sum. n and p turn a peak (n = 1) into a
/// box (large n, small p). Lists have one value a month or one for all.
struct SmoothDays {
  double latitude = 0;             ///< [deg], north positive
  std::vector<double> daily_sums;  ///< mean daily direct normal irradiation of each month [J/m^2]
  std::vector<double> n{2}, p{1};  ///< form of the day, above 0
  std::vector<double> length{1};   ///< of the day over the astronomical one
};

/// Returns why the days are not valid, or nothing. Sets `key` to the key that is wrong.
std::string problem_of(const SmoothDays& days, std::string& key);

/// Hours of sunshine between sunrise and sunset of a flat horizon [duffie2013, equation 1.6.11]; 0 in polar
/// night, 24 in polar day. `day`: 0 for 01-01; latitude in degrees.
double day_length(double latitude, int day);

/// Replaces the irradiance of a whole year of records by smooth days; the clock becomes solar time. Throws
/// Error for a record that is not a whole year, and for a month with irradiation but without sunrise.
WeatherHours with_smooth_days(WeatherHours states, const SmoothDays& days);

}  // namespace couplet::thermocline
