// SPDX-License-Identifier: Apache-2.0
// SAM CSV, what the NSRDB gives: two lines about the site, a line of column names, records by year, month,
// day, hour and minute, one or more an hour [sam_csv].
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/cells.hpp"
#include "thermocline/weather/weather_columns.hpp"
#include "thermocline/weather/weather_text.hpp"

namespace couplet::thermocline {
namespace {

const WeatherColumns::Names sam_names{{{{"DNI", "Beam", "DNI (W/m2)", "Beam normal irradiance"},
                                        {"Temperature", "Tdry", "Dry-bulb", "Air Temperature", "Temp"},
                                        {"Wind Speed", "Wspd", "Windspeed"},
                                        {"Relative Humidity", "RH", "RHum"},
                                        {"Pressure", "Pres", "Surface Pressure"}}},
                                      {"Dew Point", "Tdew", "Dewpoint", "Dew Point Temperature"},
                                      100,  // mbar
                                      -90};

/// The units that the file gives for itself, where it does, must be those that are read.
void check_units(const std::vector<std::string>& head, const std::vector<std::string>& values,
                 const std::string& place) {
  const std::pair<const char*, std::vector<std::string_view>> known[] = {
      {"DNI Units", {"w/m2", "W/m2", "W/m^2", "w/m^2"}},
      {"Temperature Units", {"c", "C", "degC"}},
      {"Pressure Units", {"mbar", "hPa"}},
      {"Wind Speed Units", {"m/s"}},
      {"Wind Speed", {"m/s"}},
      {"Relative Humidity Units", {"%"}}};
  for (const auto& [name, units] : known) {
    const auto column = column_of(head, name);
    if (!column || *column >= values.size()) continue;
    const std::string_view unit = base::trim(values[*column]);
    if (!unit.empty() && std::find(units.begin(), units.end(), unit) == units.end())
      throw Error("{}: '{}' is '{}'; only {} is supported.", place, name, unit, units.front());
  }
}

std::optional<WeatherHours::Site> read_sam_site(const std::vector<std::string>& head,
                                                const std::vector<std::string>& values,
                                                const std::string& place) {
  std::array<double, 3> found{};
  const char* wanted[] = {"Latitude", "Longitude", "Time Zone"};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto column = column_of(head, wanted[i]);
    if (!column || *column >= values.size()) return {};
    found[i] = number_in(values[*column], wanted[i], place);
  }
  return site_of(found[0], found[1], found[2], place);
}

}  // namespace

WeatherHours read_weather_sam(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  HourCollector hours(file.string());
  std::size_t head_line = 0;
  while (head_line < lines.size() && !column_of(csv::fields(lines[head_line]), "Month")) ++head_line;
  if (head_line >= std::min<std::size_t>(lines.size(), 10))
    throw Error(
        "{}: a SAM or NSRDB file must have a line with the columns Year,Month,Day,Hour among its first "
        "lines.",
        hours.place(1));
  const std::vector<std::string> head = csv::fields(lines[head_line]);
  std::optional<WeatherHours::Site> site;
  if (head_line >= 2) {
    const auto about = csv::fields(lines[head_line - 2]), values = csv::fields(lines[head_line - 1]);
    site = read_sam_site(about, values, hours.place(int(head_line)));
    check_units(about, values, hours.place(int(head_line)));
  }
  const std::string head_place = hours.place(int(head_line) + 1);
  const WeatherColumns columns(head, sam_names, head_place);
  const auto month = column_of(head, "Month"), day = column_of(head, "Day"), hour = column_of(head, "Hour"),
             minute = column_of(head, "Minute");
  if (!day || !hour) throw Error("{}: the columns Month, Day and Hour are needed.", head_place);
  HourMean mean(hours);
  double offset = 1800;  // [s]; of files without minutes
  for (std::size_t i = head_line + 1; i < lines.size(); ++i) {
    const int line = int(i) + 1;
    const std::string place = hours.place(line);
    const std::vector<std::string> fields = csv::fields(lines[i]);
    const auto number = hour_of_year(whole_number(fields, *month, "the month", place),
                                     whole_number(fields, *day, "the day", place),
                                     whole_number(fields, *hour, "the hour", place), place);
    if (!number) continue;
    const std::array<double, 5> values = columns.values(fields, place);
    const int stamp = minute ? whole_number(fields, *minute, "the minute", place) : 0;
    if (stamp < 0 || stamp > 59) throw Error("{}: the minute is {}; it must be from 0 to 59.", place, stamp);
    mean.add(*number, stamp, values, line);
    if (minute) offset = 60 * stamp;
  }
  mean.flush();
  WeatherHours result = hours.finish(mean.several() ? 1800 : offset);
  result.site = site;
  return result;
}

}  // namespace couplet::thermocline
