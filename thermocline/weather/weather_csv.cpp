// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/cells.hpp"
#include "thermocline/weather/weather_text.hpp"

namespace couplet::thermocline {
namespace {

constexpr double mid_hour = 1800;  // [s]

/// Where each column of the file goes: the hour is 5, the quantities are 0 to 4.
std::vector<std::size_t> read_head(const std::string& head, const std::string& place) {
  std::vector<std::string> known;
  for (const WeatherQuantity& q : weather_quantities) known.emplace_back(q.head);
  known.emplace_back("hour");
  std::vector<std::size_t> columns;
  for (const char other : {';', '\t'})
    if (head.find(other) != std::string::npos && head.find(',') == std::string::npos)
      throw Error(
          "{}: the columns are separated by '{}'; a weather file needs commas, with decimal points in the "
          "numbers.",
          place, other == ';' ? ";" : "a tab");
  for (const std::string& field : csv::fields(head)) {
    const std::string name(base::trim(field));
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw Error("{}: unknown column '{}'. {}", place, name.substr(0, 80),
                  base::did_you_mean(name, known, "columns"));
    const auto column = static_cast<std::size_t>(found - known.begin());
    if (std::find(columns.begin(), columns.end(), column) != columns.end())
      throw Error("{}: the column '{}' appears twice.", place, name);
    columns.push_back(column);
  }
  for (std::size_t i = 0; i < known.size(); ++i)
    if (std::find(columns.begin(), columns.end(), i) == columns.end())
      throw Error("{}: the column '{}' is missing. A weather file has the columns {}.", place, known[i],
                  base::join(known));
  return columns;
}

}  // namespace

WeatherHours read_weather_csv(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  HourCollector hours(file.string());
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int line = static_cast<int>(i) + 1;
    const std::string_view text = base::trim(lines[i]);
    if (text.empty() || text.starts_with('#')) continue;
    const std::string place = hours.place(line);
    if (columns.empty()) {
      columns = read_head(lines[i], place);
      continue;
    }
    const std::vector<std::string> fields = csv::fields(lines[i]);
    check_width(fields, columns.size(), place);
    if (fields.size() != columns.size())
      throw Error("{}: {} values, but the file has {} columns.", place, fields.size(), columns.size());
    std::array<double, 6> values;
    for (std::size_t c = 0; c < fields.size(); ++c)
      values[columns[c]] =
          number_in(fields[c], columns[c] < 5 ? weather_quantities[columns[c]].name : "the hour", place);
    const double hour = values[5];
    if (!(hour >= 0 && hour < 8784 && hour == std::floor(hour)))
      throw Error(
          "{}: the hour of the year must be a whole number from 0 to 8759, not '{}'.", place,
          fields[static_cast<std::size_t>(std::find(columns.begin(), columns.end(), 5) - columns.begin())]);
    hours.add(static_cast<int>(hour), {values[0], values[1], values[2], values[3], values[4]}, line);
  }
  return hours.finish(mid_hour);
}

}  // namespace couplet::thermocline
