// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/made_days.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "thermocline/material/numerics.hpp"

namespace couplet::thermocline {
namespace {

using std::numbers::pi;
constexpr double degree = pi / 180;

/// Declination of the sun [rad] [duffie2013, equation 1.6.1a], with January 1 as day 1.
double declination(int day) { return 23.45 * degree * std::sin(2 * pi * (285 + day) / 365.); }

struct ClimateFactors {
  double r0, r1, rk;
};
/// Corrections of the constants for the climate [hottel1976, table 2].
ClimateFactors climate(double latitude, double declination) {
  constexpr double tropic = 23.45 * degree, subarctic = 60 * degree;
  if (std::abs(latitude) <= tropic) return {0.95, 0.98, 1.02};
  if (latitude * declination < 0) return {1.03, 1.01, 1.00};
  if (std::abs(latitude) >= subarctic) return {0.99, 0.99, 1.01};
  return {0.97, 0.99, 1.02};
}

constexpr std::size_t months = 12;

double of_month(const std::vector<double>& values, std::size_t month) {
  return values.size() == 1 ? values.front() : values[month];
}

/// Hourly means of (1 - |2 t/T|^n)^p. Midpoint rule within parts of an hour: the ends of the day, where the
/// slope may be infinite, are in parts of 30 s.
std::vector<double> form(double length, double n, double p) {
  constexpr int parts = 120;
  std::vector<double> mean(hours_a_day, 0.0);
  for (int i = 0; i < hours_a_day * parts; ++i) {
    const double x = std::abs(2 * ((i + 0.5) / parts - 12) / length);
    if (x < 1) mean[std::size_t(i / parts)] += std::pow(1 - std::pow(x, n), p) / parts;
  }
  return mean;
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
  const ClimateFactors c = climate(site.latitude * degree, declination(day));
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
    year.temperature.push_back(celsius(site.temperature) + 8 * std::cos(phase));
    year.wind.push_back(site.wind);
    year.pressure.push_back(pressure);
  }
  return year;
}

std::string problem_of(const SmoothDays& d, std::string& key) {
  key = "daily-sums";
  if (d.daily_sums.size() != months)
    return fmt::format("has {} values; expected one for each of the 12 months, January first",
                       d.daily_sums.size());
  constexpr double least = 36e3;  // [J/m^2]: 10 Wh
  const double highest = *std::max_element(d.daily_sums.begin(), d.daily_sums.end());
  if (highest > 0 && highest < least)
    return fmt::format(
        "the largest daily sum is {:g} J/m^2: too small. A number without a unit is in J/m^2; write "
        "'{:g} kWh/m^2' if that is intended",
        highest, highest);
  for (const double sum : d.daily_sums)
    if (sum < 0 || sum > 24 * 1412 * seconds_an_hour)
      return fmt::format(
          "{:g} J/m^2 is not a plausible daily sum; expected 0 to 33 kWh/m^2 (with its unit: 7.2 kWh/m^2)",
          sum);
  for (const auto& [name, values] :
       {std::pair{"form-n", &d.n}, {"form-p", &d.p}, {"day-length", &d.length}}) {
    key = name;
    if (values->size() != 1 && values->size() != months)
      return fmt::format("has {} values; expected one, or one for each of the 12 months", values->size());
    for (const double v : *values)
      if (!(v > 0 && v <= 100))
        return fmt::format("{:g} is out of range; expected above 0 and at most 100", v);
  }
  return "";
}

double day_length(double latitude, int day) {
  // cos(omega_s) = -tan(phi) tan(delta), from the sun's height at noon and at midnight: sin sin + cos cos
  // cos.
  const double noon = sine_of_sun_height(latitude, day, 12), midnight = sine_of_sun_height(latitude, day, 0);
  const double cosine = -(noon + midnight) / std::max(noon - midnight, 1e-12);
  return 24 / std::numbers::pi * std::acos(std::clamp(cosine, -1.0, 1.0));
}

WeatherHours with_smooth_days(WeatherHours record, const SmoothDays& d) {
  if (record.days() != days_a_year)
    throw Error("{}: smooth days need air data of a whole year; this file has {} days.", record.source,
                record.days());
  for (int day = 0; day < days_a_year; ++day) {
    const auto month = std::size_t(month_of_day(day));
    const double sum = d.daily_sums[month];
    const double sunny = day_length(d.latitude, day), length = of_month(d.length, month) * sunny;
    if (length > 24 * (1 + 1e-9))
      throw Error(
          "smooth days: day-length {:g} makes a day of {:.1f} h on {}, where the sun is up for {:.1f} h "
          "at latitude {:g} deg: it would shine at midnight.",
          of_month(d.length, month), length, date_of_day(day), sunny, d.latitude);
    const std::vector<double> mean = form(length, of_month(d.n, month), of_month(d.p, month));
    double total = 0;
    for (const double m : mean) total += m * seconds_an_hour;
    if (sum > 0 && total <= 0)
      throw Error(
          "smooth days: on {} the sun does not rise at latitude {:g} deg, but daily-sums gives that "
          "month {:g} J/m^2 per day.",
          date_of_day(day), d.latitude, sum);
    for (std::size_t h = 0; h < hours_a_day; ++h) {
      const double dni = sum > 0 ? sum / total * mean[h] : 0;
      if (dni > 1412)
        throw Error(
            "smooth days: on {} the irradiance reaches {:.0f} W/m^2, more than outside the atmosphere; "
            "lower 'daily-sums' or widen the day (form-n, form-p, day-length).",
            date_of_day(day), dni);
      record.dni[std::size_t(day) * hours_a_day + h] = dni;
    }
  }
  record.site = WeatherHours::Site{d.latitude, 0};
  return record;
}

}  // namespace couplet::thermocline
