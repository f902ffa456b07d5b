// SPDX-License-Identifier: Apache-2.0
#include "common/base/error.hpp"
#include "common/csv/cells.hpp"
#include "thermocline/weather/weather_columns.hpp"
#include "thermocline/weather/weather_date.hpp"
#include "thermocline/weather/weather_text.hpp"

namespace couplet::thermocline {
namespace {

// The format of EnergyPlus [epw], columns counted from 0.
constexpr std::size_t header_lines = 8, month = 1, day = 2, hour = 3, minute = 4, fewest_columns = 22,
                      most_columns = 35;
constexpr double end_of_hour = 3600;  // [s]
struct EpwColumn {
  std::size_t number;
  double missing_from;  ///< this value and above stand for "missing"
};
/// In the order of weather_quantities: irradiance, temperature, wind, humidity, pressure.
constexpr std::array<EpwColumn, 5> columns{{{14, 9999}, {6, 99.9}, {21, 999}, {8, 999}, {9, 999999}}};

/// LOCATION,city,region,country,source,number,latitude,longitude,time zone,altitude
WeatherHours::Site read_epw_site(const std::string& line, const std::string& place) {
  const std::vector<std::string> fields = csv::fields(line);
  if (fields.size() < 9)
    throw Error("{}: the line LOCATION must contain latitude, longitude and time zone.", place);
  const double latitude = number_in(fields[6], "the latitude", place);
  const double longitude = number_in(fields[7], "the longitude", place);
  const double zone = number_in(fields[8], "the time zone", place);
  return site_of(latitude, longitude, zone, place);
}

}  // namespace

WeatherHours read_weather_epw(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  HourCollector hours(file.string());
  if (lines.size() <= header_lines || !lines[0].starts_with("LOCATION,"))
    throw Error(
        "{}: this is not an EPW file: it must start with a line LOCATION,... and have {} header lines.",
        hours.place(1), header_lines);
  HourMean mean(hours);
  for (std::size_t i = header_lines; i < lines.size(); ++i) {
    const int line = static_cast<int>(i) + 1;
    const std::string place = hours.place(line);
    const std::vector<std::string> fields = csv::fields(lines[i]);
    if (fields.size() < fewest_columns)
      throw Error("{}: {} columns; an EPW record has {}.", place, fields.size(), most_columns);
    check_width(fields, most_columns, place);
    const int m = whole_number(fields, month, "the month", place),
              d = whole_number(fields, day, "the day", place);
    if (m == 2 && d == 29) continue;  // a reference year has 365 days
    const int h = whole_number(fields, hour, "the hour", place);
    if (h < 1 || h > hours_a_day)
      throw Error("{}: the hour is {}; it must be from 1 to {}.", place, h, hours_a_day);
    int number = 0;
    try {
      number = day_of_year(fmt::format("{:02d}-{:02d}", m, d)) * hours_a_day + h - 1;
    } catch (const Error& error) {
      throw Error("{}: {}", place, error.what());
    }
    std::array<double, 5> values;
    for (std::size_t q = 0; q < values.size(); ++q) {
      values[q] = number_in(fields[columns[q].number], weather_quantities[q].name, place);
      if (values[q] >= columns[q].missing_from) values[q] = missing;
    }
    const int stamp = whole_number(fields, minute, "the minute", place);
    if (stamp < 0 || stamp > 60) throw Error("{}: the minute is {}; it must be from 0 to 60.", place, stamp);
    mean.add(number, stamp, values, line);
  }
  mean.flush();
  WeatherHours result = hours.finish(mean.several() ? 60 * mean.mean_minute() : end_of_hour);
  result.site = read_epw_site(lines[0], hours.place(1));
  return result;
}

}  // namespace couplet::thermocline
