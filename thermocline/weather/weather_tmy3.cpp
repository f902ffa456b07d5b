// SPDX-License-Identifier: Apache-2.0
// TMY3: a line about the site, a line of column names, records by date and hour 01:00 to 24:00; irradiance of
// the hour that ends then, states at that moment [wilcox2008].
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/cells.hpp"
#include "thermocline/weather/weather_columns.hpp"
#include "thermocline/weather/weather_text.hpp"

namespace couplet::thermocline {
namespace {

const WeatherColumns::Names tmy3_names{
    {{{"DNI (W/m^2)"}, {"Dry-bulb (C)"}, {"Wspd (m/s)"}, {"RHum (%)"}, {"Pressure (mbar)"}}},
    {"Dew-point (C)"},
    100,  // mbar
    -90};

/// number,name,state,time zone,latitude,longitude,elevation
WeatherHours::Site read_tmy3_site(const std::string& line, const std::string& place) {
  const std::vector<std::string> fields = csv::fields(line);
  if (fields.size() < 7)
    throw Error(
        "{}: the first line of a TMY3 file must contain number, name, state, time zone, latitude, longitude "
        "and elevation; this one has {} fields.",
        place, fields.size());
  return site_of(number_in(fields[4], "the latitude", place), number_in(fields[5], "the longitude", place),
                 number_in(fields[3], "the time zone", place), place);
}

}  // namespace

WeatherHours read_weather_tmy3(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  HourCollector hours(file.string());
  const std::vector<std::string> head = csv::fields(lines.at(1));
  const WeatherColumns columns(head, tmy3_names, hours.place(2));
  const auto date = column_of(head, "Date (MM/DD/YYYY)"), time = column_of(head, "Time (HH:MM)");
  if (!date || !time)
    throw Error("{}: the columns Date (MM/DD/YYYY) and Time (HH:MM) are needed.", hours.place(2));
  const WeatherHours::Site site = read_tmy3_site(lines[0], hours.place(1));
  for (std::size_t i = 2; i < lines.size(); ++i) {
    const int line = int(i) + 1;
    const std::string place = hours.place(line);
    const std::vector<std::string> fields = csv::fields(lines[i]);
    if (fields.size() < head.size())
      throw Error("{}: {} values, but the file has {} columns.", place, fields.size(), head.size());
    const std::vector<std::string> day = base::split(fields[*date], '/'),
                                   clock = base::split(fields[*time], ':');
    if (day.size() != 3 || clock.size() != 2)
      throw Error("{}: '{},{}' is not a date MM/DD/YYYY and time HH:MM.", place, fields[*date],
                  fields[*time]);
    const int hour = whole_number(clock, 0, "the hour", place);
    if (hour < 1 || hour > 24 || whole_number(clock, 1, "the minute", place) != 0)
      throw Error("{}: the time is {}; a TMY3 file has full hours from 01:00 to 24:00.", place,
                  fields[*time]);
    const auto number = hour_of_year(whole_number(day, 0, "the month", place),
                                     whole_number(day, 1, "the day", place), hour - 1, place);
    if (number) hours.add(*number, columns.values(fields, place), line);
  }
  WeatherHours result = hours.finish(3600);
  result.site = site;
  return result;
}

}  // namespace couplet::thermocline
