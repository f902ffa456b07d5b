// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "thermocline/weather/weather_date.hpp"
#include "thermocline/weather/weather_text.hpp"

namespace couplet::thermocline {
namespace {

constexpr std::size_t temperature = 1, humidity = 3, pressure = 4;

std::string lower(std::string_view text) {
  std::string result(base::trim(text));
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return result;
}

/// Relative humidity [%] from temperature and dew point [degC], Magnus' formula.
double humidity_of(double t, double dew) {
  const auto pressure_of = [](double c) { return std::exp(17.625 * c / (243.04 + c)); };
  return std::min(100.0, 100 * pressure_of(dew) / pressure_of(t));
}

}  // namespace

std::optional<std::size_t> column_of(const std::vector<std::string>& head, std::string_view name) {
  for (std::size_t i = 0; i < head.size(); ++i)
    if (lower(head[i]) == lower(name)) return i;
  return {};
}

WeatherColumns::WeatherColumns(const std::vector<std::string>& head, const Names& names,
                               const std::string& place)
    : names_(names), n_(head.size()) {
  const auto find = [&](const std::vector<std::string_view>& known) -> std::optional<std::size_t> {
    for (const std::string_view name : known)
      if (const auto found = column_of(head, name)) return found;
    return {};
  };
  const auto once = [&](std::optional<std::size_t> column) {
    for (std::size_t i = 0; column && i < head.size(); ++i)
      if (i != *column && lower(head[i]) == lower(head[*column]))
        throw Error("{}: the column '{}' appears twice.", place, base::trim(head[i]));
  };
  dew_point_ = find(names.dew_point);
  once(dew_point_);
  for (std::size_t q = 0; q < column_.size(); ++q) {
    column_[q] = find(names.of[q]);
    once(column_[q]);
    if (column_[q] || (q == humidity && dew_point_)) continue;
    std::vector<std::string> known(names.of[q].begin(), names.of[q].end());
    if (q == humidity) known.insert(known.end(), names.dew_point.begin(), names.dew_point.end());
    throw Error("{}: the column for the {} is missing; it may be named {}.", place,
                weather_quantities[q].name, base::join(known));
  }
}

std::array<double, 5> WeatherColumns::values(const std::vector<std::string>& fields,
                                             const std::string& place) const {
  if (fields.size() < n_)
    throw Error("{}: {} values, but the file has {} columns.", place, fields.size(), n_);
  check_width(fields, n_, place);
  const auto at = [&](std::size_t column, std::string_view name) {
    const double value = number_in(fields[column], name, place);
    return value < names_.missing_below ? missing : value;
  };
  std::array<double, 5> result;
  for (std::size_t q = 0; q < result.size(); ++q)
    result[q] = column_[q] ? at(*column_[q], weather_quantities[q].name) : missing;
  result[pressure] *= names_.pressure_factor;
  if (!column_[humidity])
    result[humidity] = humidity_of(result[temperature], at(*dew_point_, "the dew point"));
  if (result[0] < 0 && result[0] > -1) result[0] = 0;  // "-0.0" and offsets of instruments
  return result;
}

int whole_number(const std::vector<std::string>& fields, std::size_t column, std::string_view name,
                 const std::string& place) {
  if (column >= fields.size()) throw Error("{}: the line ends before {}.", place, name);
  const double value = number_in(fields[column], name, place);
  if (!(std::abs(value) < 1e5) || value != std::floor(value))
    throw Error("{}: {} must be a whole number, not '{}'.", place, name, fields[column]);
  return static_cast<int>(value);
}

std::optional<int> hour_of_year(int month, int day, int hour, const std::string& place) {
  if (hour < 0 || hour >= hours_a_day)
    throw Error("{}: the hour is {}; it must be from 0 to 23.", place, hour);
  if (month == 2 && day == 29) return {};
  try {
    return day_of_year(fmt::format("{:02d}-{:02d}", month, day)) * hours_a_day + hour;
  } catch (const Error& error) {
    throw Error("{}: {}", place, error.what());
  }
}

WeatherHours::Site site_of(double latitude, double longitude, double zone, const std::string& place) {
  if (!(std::abs(latitude) <= 90 && std::abs(longitude) <= 180 && std::abs(zone) <= 14))
    throw Error("{}: latitude {:g}, longitude {:g} and time zone {:g} are not a valid location.", place,
                latitude, longitude, zone);
  constexpr double seconds_a_degree = 240;  // the earth turns by 15 degrees an hour
  return {latitude, longitude * seconds_a_degree - 3600 * zone};
}

}  // namespace couplet::thermocline
