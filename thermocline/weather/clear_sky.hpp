// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "thermocline/weather/weather_hours.hpp"

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

/// Of the sun above the horizon at solar time `hour` (12 is noon) of `day` (0 for 01-01); negative at night.
/// Latitude in degrees [duffie2013, equation 1.6.5].
double sine_of_sun_height(double latitude, int day, double hour);

/// Direct normal irradiance [W/m^2] at solar time `hour` of `day`. Transmittance of the
/// cloudless standard atmosphere with 23 km visibility a0 + a1 exp(-k / cos(zenith)) [hottel1976],
/// extraterrestrial irradiance and declination [duffie2013, equations 1.4.1a and 1.6.1a].
double clear_sky_irradiance(const ClearSky& site, int day, double hour);

/// The year, hour by hour: means of the irradiance over each hour, air temperature as a sine of one day,
/// pressure of the standard atmosphere at this altitude. The clock shows solar time.
WeatherHours clear_sky_year(const ClearSky& site);

}  // namespace couplet::thermocline
