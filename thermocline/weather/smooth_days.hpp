// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "thermocline/weather/weather_hours.hpp"

namespace couplet::thermocline {

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

/// What is wrong with it: a sentence, or empty. Names the key that it is about in `key`.
std::string problem_of(const SmoothDays& days, std::string& key);

/// Hours of sunshine between sunrise and sunset of a flat horizon [duffie2013, equation 1.6.11]; 0 in polar
/// night, 24 in polar day. `day`: 0 for 01-01; latitude in degrees.
double day_length(double latitude, int day);

/// Replaces the irradiance of a whole year of records by smooth days; the clock becomes solar time. Throws
/// Error for a record that is not a whole year, and for a month with irradiation but without sunrise.
WeatherHours with_smooth_days(WeatherHours states, const SmoothDays& days);

}  // namespace couplet::thermocline
