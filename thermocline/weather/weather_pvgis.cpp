// SPDX-License-Identifier: Apache-2.0
// PVGIS, the typical year as CSV: lines with latitude and longitude, the year of each month, column names,
// records by time (UTC), a legend. Values belong to the moment of the record.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/cells.hpp"
#include "thermocline/weather/weather_columns.hpp"
#include "thermocline/weather/weather_text.hpp"

namespace couplet::thermocline {
namespace {

const WeatherColumns::Names pvgis_names{{{{"Gb(n)"}, {"T2m"}, {"WS10m"}, {"RH"}, {"SP"}}}, {}, 1, -90};

/// Means over each hour of a year's moments, `offset` hours after the begin of each: the integral of the straight
/// lines between them. The sum over the record stays.
std::vector<double> hourly_means(const std::vector<double>& moment, double offset) {
  const int n = int(moment.size()), whole = int(std::floor(offset));
  const double x = offset - whole;
  const auto at = [&](int h) { return moment[std::size_t(((h - whole) % n + n) % n)]; };
  std::vector<double> mean(moment.size());
  for (int h = 0; h < n; ++h)
    mean[std::size_t(h)] =
        0.5 * x * x * at(h - 1) + (0.5 + x - x * x) * at(h) + 0.5 * (1 - x) * (1 - x) * at(h + 1);
  return mean;
}

/// The line after the last record: an empty one, and behind it a legend.
std::size_t end_of_records(const std::vector<std::string>& lines, std::size_t first,
                           const HourCollector& hours) {
  const auto is_record = [](const std::string& line) {
    return line.size() > 13 && line[8] == ':' && line[13] == ',' &&
           std::all_of(line.begin(), line.begin() + 8, [](unsigned char c) { return std::isdigit(c); });
  };
  std::size_t end = first;
  while (end < lines.size() && !base::trim(lines[end]).empty()) ++end;
  for (std::size_t i = end; i < lines.size(); ++i)
    if (is_record(lines[i]))
      throw Error("{}: a record after the empty line {}, which ends the records of a PVGIS file.",
                  hours.place(int(i) + 1), end + 1);
  return end;
}

/// The number behind "Latitude (decimal degrees): " and its like among the first lines.
double number_behind(const std::vector<std::string>& lines, std::size_t end, std::string_view word,
                     const HourCollector& hours, std::optional<double> without = {}) {
  for (std::size_t i = 0; i < end; ++i)
    if (base::trim(lines[i]).starts_with(word)) {
      const auto colon = lines[i].find(':');
      if (colon != std::string::npos)
        return number_in(lines[i].substr(colon + 1), word, hours.place(int(i) + 1));
    }
  if (without) return *without;
  throw Error("{}: the first lines of a PVGIS file must contain '{} (decimal degrees): ...'.", hours.place(1),
              word);
}

}  // namespace

WeatherHours read_weather_pvgis(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  HourCollector hours(file.string());
  std::size_t head_line = 0;
  while (head_line < lines.size() && !column_of(csv::fields(lines[head_line]), "time(UTC)")) ++head_line;
  if (head_line == lines.size())
    throw Error(
        "{}: the line 'time(UTC),T2m,RH,...' is missing: only the typical year (TMY) of PVGIS as CSV is "
        "supported, not its hourly or monthly radiation.",
        hours.place(1));
  const double latitude = number_behind(lines, head_line, "Latitude", hours),
               longitude = number_behind(lines, head_line, "Longitude", hours);
  const double offset = number_behind(lines, head_line, "Irradiance Time Offset", hours, 0);  // [h]
  if (!(std::abs(offset) <= 1))
    throw Error("{}: the irradiance time offset is {:g} h; expected -1 to 1.", hours.place(1), offset);
  const WeatherHours::Site site = site_of(latitude, longitude, 0, hours.place(1));
  std::optional<int> minutes;
  const std::vector<std::string> head = csv::fields(lines[head_line]);
  const auto time = column_of(head, "time(UTC)");
  const WeatherColumns columns(head, pvgis_names, hours.place(int(head_line) + 1));
  const std::size_t end = end_of_records(lines, head_line + 1, hours);
  for (std::size_t i = head_line + 1; i < end; ++i) {
    const int line = int(i) + 1;
    const std::string place = hours.place(line);
    const std::vector<std::string> fields = csv::fields(lines[i]);
    if (*time >= fields.size()) throw Error("{}: the line ends before its time.", place);
    const std::string& stamp = fields[*time];
    if (stamp.size() != 13 || stamp[8] != ':')
      throw Error("{}: '{}' is not a time YYYYMMDD:HHMM.", place, stamp);
    const std::vector<std::string> parts{stamp.substr(4, 2), stamp.substr(6, 2), stamp.substr(9, 2),
                                         stamp.substr(11, 2)};
    const int minute = whole_number(parts, 3, "the minute", place);
    if (minute < 0 || minute > 59 || minute != minutes.value_or(minute))
      throw Error("{}: the minute is {}; all records of a PVGIS file must have the same, from 0 to 59.",
                  place, minute);
    minutes = minute;
    const auto number =
        hour_of_year(whole_number(parts, 0, "the month", place), whole_number(parts, 1, "the day", place),
                     whole_number(parts, 2, "the hour", place), place);
    if (number) hours.add(*number, columns.values(fields, place), line);
  }
  const double stamp = minutes.value_or(0) / 60.0;  // [h]
  WeatherHours result = hours.finish(3600 * stamp);
  result.site = site;
  constexpr double degrees_an_hour = 15;
  result.local_ahead = int(std::lround(longitude / degrees_an_hour));
  result.dni = hourly_means(result.dni, stamp + offset);
  return result;
}

WeatherHours read_weather(const std::filesystem::path& file) {
  const std::filesystem::path plain = file.extension() == ".gz" ? file.stem() : file;
  if (plain.extension() == ".epw") return read_weather_epw(file);
  if (plain.extension() == ".json")
    throw Error("{}:1: JSON is not supported; request the same year as CSV or EPW.", file.string());
  const std::vector<std::string> lines = read_lines(file);
  const std::vector<std::string> first = csv::fields(lines.empty() ? "" : lines[0]),
                                 second = csv::fields(lines.size() > 1 ? lines[1] : "");
  if (!lines.empty() && lines[0].starts_with("LOCATION,")) return read_weather_epw(file);
  if (!lines.empty() && base::trim(lines[0]).starts_with("Latitude (")) return read_weather_pvgis(file);
  if (column_of(second, "Date (MM/DD/YYYY)")) return read_weather_tmy3(file);
  if (column_of(first, "Time Zone") || (column_of(first, "Month") && column_of(first, "Hour")))
    return read_weather_sam(file);
  return read_weather_csv(file);
}

}  // namespace couplet::thermocline
