// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/error.hpp"
#include "thermocline/material/numerics.hpp"

namespace couplet::thermocline {
namespace {

/// Monotonised central difference: zero at an extremum, never beyond twice a one-sided difference.
double limited_slope(double before, double here, double after) {
  const double left = here - before, right = after - here;
  if (left * right <= 0) return 0;
  const double size = std::min({2 * std::abs(left), 2 * std::abs(right), std::abs(left + right) / 2});
  return std::copysign(size, left);
}

/// Which hour of the record each hour of the period is. A shift moves the record's hours to a later clock.
std::vector<std::size_t> chosen_hours(const WeatherHours& record, const WeatherPeriod& period, int shift) {
  const int first = record.first_day, days = record.days();
  const bool whole_year = days == days_a_year;
  const int begin = period.from;
  int count = whole_year ? days_a_year : std::max(1, first + days - begin);
  if (period.to) count = (*period.to - begin + days_a_year) % days_a_year + 1;
  for (int d = 0; d < count; ++d) {
    const int day = (begin + d) % days_a_year;
    if (day < first || day >= first + days)
      throw Error("{}: this file has no weather for {}; it covers {} to {}.", record.source, date_of_day(day),
                  date_of_day(first), date_of_day(first + days - 1));
  }
  const int n = days * hours_a_day;
  std::vector<std::size_t> chosen;
  for (int h = 0; h < count * hours_a_day; ++h) {
    const int in_year = (begin * hours_a_day + h) % (days_a_year * hours_a_day) - first * hours_a_day - shift;
    chosen.push_back(static_cast<std::size_t>((in_year % n + n) % n));
  }
  return chosen;
}

}  // namespace

WeatherHours with_mean_days(WeatherHours record) {
  std::array<std::array<double, hours_a_day>, 12> sum{};
  std::array<double, 12> days{};
  const auto month = [&](int day) { return static_cast<std::size_t>(month_of_day(record.first_day + day)); };
  for (int d = 0; d < record.days(); ++d) {
    for (std::size_t h = 0; h < hours_a_day; ++h)
      sum[month(d)][h] += record.dni[std::size_t(d) * hours_a_day + h];
    ++days[month(d)];
  }
  for (int d = 0; d < record.days(); ++d)
    for (std::size_t h = 0; h < hours_a_day; ++h)
      record.dni[std::size_t(d) * hours_a_day + h] = sum[month(d)][h] / days[month(d)];
  return record;
}

std::vector<std::string> doubts_about_sun(const WeatherHours& record) {
  constexpr std::size_t fortnight = 14 * hours_a_day;
  if (record.dni.size() >= fortnight && *std::max_element(record.dni.begin(), record.dni.end()) <= 0)
    return {fmt::format("{}: no direct irradiance in any of its {} days", record.source, record.days())};
  if (!record.site) return {};
  constexpr double hour = 3600, day = hours_a_day * hour;  // [s]
  constexpr double farthest_clock = 3;                     // [h]: 45 degrees
  // A degree below the horizon: refraction and the size of the sun's disc.
  constexpr double horizon = -0.02, most_in_the_dark = 0.01;
  std::vector<std::string> all;
  const WeatherHours::Site& site = *record.site;
  const double ahead = site.solar_ahead / hour;
  if (std::abs(ahead) > farthest_clock)
    all.push_back(fmt::format(
        "{}: the solar time of its longitude is {:.1f} h {} its time zone: is the sign of longitude or "
        "time zone wrong?",
        record.source, std::abs(ahead), ahead > 0 ? "ahead of" : "behind"));
  double total = 0, dark = 0;
  for (std::size_t h = 0; h < record.dni.size(); ++h) {
    if (record.dni[h] <= 0) continue;
    double highest = -1;
    for (const double part : {0.0, 0.5, 1.0}) {
      const double solar = (double(h) + part) * hour + site.solar_ahead, whole_days = std::floor(solar / day);
      highest = std::max(highest, sine_of_sun_height(site.latitude, record.first_day + int(whole_days),
                                                     (solar - whole_days * day) / hour));
    }
    total += record.dni[h];
    if (highest < horizon) dark += record.dni[h];
  }
  if (dark > most_in_the_dark * total)
    all.push_back(fmt::format(
        "{}: {:.0f} % of the irradiation is in hours with the sun below the horizon at latitude {:g} "
        "deg: latitude, longitude and time zone do not match this record",
        record.source, 100 * dark / total, site.latitude));
  return all;
}

Weather::Weather(const WeatherHours& record, const WeatherPeriod& period, int shift_hours)
    : first_day_(period.from), shift_hours_(shift_hours) {
  const std::vector<std::size_t> chosen = chosen_hours(record, period, shift_hours);
  hours_.source = record.source;
  hours_.state_offset = record.state_offset;
  hours_.site = record.site;
  hours_.warnings = record.warnings;
  hours_.doubts = record.doubts;
  mean_temperature_ = kelvin(std::accumulate(record.temperature.begin(), record.temperature.end(), 0.) /
                             double(record.temperature.size()));
  for (const auto quantity : weather_quantities)
    for (const std::size_t h : chosen) (hours_.*quantity).push_back((record.*quantity)[h]);
  const std::vector<double>& dni = hours_.dni;
  const std::size_t n = dni.size();
  cumulated_.assign(n + 1, 0);
  for (std::size_t h = 0; h < n; ++h) {
    slope_.push_back(limited_slope(dni[(h + n - 1) % n], dni[h], dni[(h + 1) % n]));
    cumulated_[h + 1] = cumulated_[h] + dni[h] * seconds_an_hour;
  }
}

double Weather::wrapped(double t) const {
  const double length = period_length();
  const double in = t - length * std::floor(t / length);
  return in < length ? in : 0;
}

double Weather::state(const std::vector<double>& values, double t) const {
  const std::size_t n = values.size();
  const double position = wrapped(t - hours_.state_offset) / seconds_an_hour;
  const auto h = std::min(static_cast<std::size_t>(position), n - 1);
  const double share = position - double(h);
  return (1 - share) * values[h] + share * values[(h + 1) % n];
}

Ambient Weather::at(double t) const {
  const double position = wrapped(t) / seconds_an_hour;
  const auto h = std::min(static_cast<std::size_t>(position), hours_.dni.size() - 1);
  Ambient ambient;
  ambient.dni = hours_.dni[h] + slope_[h] * (position - double(h) - 0.5);
  ambient.temperature = kelvin(state(hours_.temperature, t));
  ambient.wind = state(hours_.wind, t);
  ambient.humidity = state(hours_.humidity, t);
  ambient.pressure = state(hours_.pressure, t);
  ambient.sun_height = sun_height(t);
  return ambient;
}

double Weather::sun_height(double t) const {
  if (!hours_.site) return 0;
  const double solar = t - shift_hours_ * seconds_an_hour + hours_.site->solar_ahead,
               day = hours_a_day * seconds_an_hour;
  const double whole_days = std::floor(solar / day);
  return std::max(0., sine_of_sun_height(hours_.site->latitude, first_day_ + static_cast<int>(whole_days),
                                         (solar - whole_days * day) / seconds_an_hour));
}

/// Within the first period: integral of the line mean + slope (x - 1/2), x the share of the hour gone.
double Weather::irradiation_since_start(double t) const {
  const double position = t / seconds_an_hour;
  const auto h = std::min(static_cast<std::size_t>(position), hours_.dni.size() - 1);
  const double x = position - double(h);
  return cumulated_[h] + seconds_an_hour * x * (hours_.dni[h] + slope_[h] * (x - 1) / 2);
}

double Weather::irradiation(double from, double to) const {
  const double length = period_length();
  const double rounds = std::floor(to / length) - std::floor(from / length);
  return rounds * cumulated_.back() + irradiation_since_start(wrapped(to)) -
         irradiation_since_start(wrapped(from));
}

std::string Weather::date(double t) const {
  return date_of_day(first_day_ + static_cast<int>(std::floor(wrapped(t) / (hours_a_day * seconds_an_hour))));
}

}  // namespace couplet::thermocline
