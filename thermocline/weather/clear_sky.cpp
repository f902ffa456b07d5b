// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/clear_sky.hpp"

#include <cmath>
#include <numbers>

#include "thermocline/base/celsius.hpp"
#include "thermocline/weather/weather_date.hpp"

namespace couplet::thermocline {
namespace {

using std::numbers::pi;
constexpr double degree = pi / 180;

/// Declination of the sun [rad] [duffie2013, equation 1.6.1a], where the first of January is day 1.
double declination(int day) { return 23.45 * degree * std::sin(2 * pi * (285 + day) / 365.); }

struct Correction {
  double r0, r1, rk;
};
/// Of the constants for the climate [hottel1976, table 2].
Correction climate(double latitude, double declination) {
  constexpr double tropic = 23.45 * degree, subarctic = 60 * degree;
  if (std::abs(latitude) <= tropic) return {0.95, 0.98, 1.02};
  if (latitude * declination < 0) return {1.03, 1.01, 1.00};
  if (std::abs(latitude) >= subarctic) return {0.99, 0.99, 1.01};
  return {0.97, 0.99, 1.02};
}

}  // namespace

double sine_of_sun_height(double latitude, int day, double hour) {
  const double delta = declination(day), omega = (hour - 12) * 15 * degree, phi = latitude * degree;
  return std::sin(phi) * std::sin(delta) + std::cos(phi) * std::cos(delta) * std::cos(omega);
}

double clear_sky_irradiance(const ClearSky& site, int day, double hour) {
  const double cos_zenith = sine_of_sun_height(site.latitude, day, hour);
  if (cos_zenith <= 0) return 0;
  const double km = site.altitude / 1000;
  const Correction c = climate(site.latitude * degree, declination(day));
  const double a0 = c.r0 * (0.4237 - 0.00821 * (6 - km) * (6 - km));
  const double a1 = c.r1 * (0.5055 + 0.00595 * (6.5 - km) * (6.5 - km));
  const double k = c.rk * (0.2711 + 0.01858 * (2.5 - km) * (2.5 - km));
  const double outside = 1367 * (1 + 0.033 * std::cos(2 * pi * (day + 1) / 365.));
  return outside * (a0 + a1 * std::exp(-k / cos_zenith));
}

WeatherHours clear_sky_year(const ClearSky& site) {
  WeatherHours year;
  year.source = "clear sky";
  year.state_offset = 1800;
  year.site = WeatherHours::Site{site.latitude, 0};
  constexpr int parts = 60;  // of an hour, for its mean
  const double pressure = 101325 * std::pow(1 - 2.25577e-5 * site.altitude, 5.25588);
  for (int h = 0; h < days_a_year * hours_a_day; ++h) {
    const int day = h / hours_a_day, clock = h % hours_a_day;
    double sum = 0;
    for (int i = 0; i < parts; ++i) sum += clear_sky_irradiance(site, day, clock + (i + 0.5) / parts);
    year.dni.push_back(sum / parts);
    const double phase = 2 * pi * (clock + 0.5 - 15) / hours_a_day;
    year.temperature.push_back(celsius((site.coldest + site.warmest) / 2) +
                               (site.warmest - site.coldest) / 2 * std::cos(phase));
    year.wind.push_back(site.wind);
    year.humidity.push_back(site.humidity);
    year.pressure.push_back(pressure);
  }
  return year;
}

}  // namespace couplet::thermocline
