// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "thermocline/weather/weather_file.hpp"

/// Synthetic years: cloudless days, and days of a given energy and shape.
namespace couplet::thermocline {

/// Year of cloudless days; a new site requires only its latitude.
struct ClearSky {
  double latitude = 0;          ///< [deg], north positive
  double altitude = 0;          ///< above the sea [m], below 2500
  double temperature = 293.15;  ///< mean of the air; 8 K more at 15:00, 8 K less at 03:00 [K]
  double wind = 2;              ///< [m/s]
};

/// Sine of the sun's height at solar time `hour` (12 is noon) of `day` (0 for 01-01); negative at night.
/// Latitude in degrees [duffie2013, equation 1.6.5].
double sine_of_sun_height(double latitude, int day, double hour);

/// Direct normal irradiance [W/m^2] at solar time `hour` of `day`. Uses the transmittance a0 + a1
/// exp(-k/cos(zenith)) of the cloudless standard atmosphere with 23 km visibility [hottel1976], and
/// extraterrestrial irradiance and declination [duffie2013, equations 1.4.1a and 1.6.1a].
double clear_sky_irradiance(const ClearSky& site, int day, double hour);

/// Hourly data of the year: mean irradiance of each hour, sinusoidal daily air temperature, pressure of the
/// standard atmosphere at this altitude. The clock is solar time.
WeatherHours clear_sky_year(const ClearSky& site);

/// Cloudless days of a given energy and shape, for sites with only monthly sums. On a day of length T (from
/// latitude and declination, times `length`) the direct normal irradiance is
///   DNI(t) = A (1 - |2 (t - noon)/T|^n)^p,   |t - noon| < T/2,
/// where A gives each day the monthly mean of the daily sum. n and p range from a peak (n = 1) to a box
/// (large n, small p). Lists have one value per month or a single one.
struct SmoothDays {
  double latitude = 0;             ///< [deg], north positive
  std::vector<double> daily_sums;  ///< mean daily direct normal irradiation of each month [J/m^2]
  std::vector<double> n{2}, p{1};  ///< shape of the day, above 0
  std::vector<double> length{1};   ///< ratio to the astronomical day length
};

/// Returns why the days are invalid, or nothing. Sets `key` to the incorrect key.
std::string problem_of(const SmoothDays& days, std::string& key);

/// Hours of sunshine between sunrise and sunset of a flat horizon [duffie2013, equation 1.6.11]; 0 in polar
/// night, 24 in polar day. `day`: 0 for 01-01; latitude in degrees.
double day_length(double latitude, int day);

/// Replaces the irradiance of complete years by smooth days; the clock becomes solar time. Throws Error for
/// incomplete years, and for a month with irradiation but without sunrise.
WeatherHours with_smooth_days(WeatherHours states, const SmoothDays& days);

}  // namespace couplet::thermocline
