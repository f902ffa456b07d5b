// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/csv_reader.hpp"

namespace couplet::thermocline {
namespace {

constexpr std::array<int, 12> days_a_month{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};

/// Month and day of the month, both from 0.
std::pair<int, int> split_day(int day) {
  day = (day % days_a_year + days_a_year) % days_a_year;
  std::size_t month = 0;
  while (day >= days_a_month[month]) day -= days_a_month[month++];
  return {int(month), day};
}

struct WeatherColumn {
  std::string name, head;  ///< in messages and in the CSV
  double lowest, highest;
  double factor;  ///< from the unit of the CSV
};
/// Quantities of a record in the order of the CSV columns.
constexpr std::vector<double> WeatherHours::*weather_quantities[] = {
    &WeatherHours::dni, &WeatherHours::temperature, &WeatherHours::wind, &WeatherHours::humidity,
    &WeatherHours::pressure};
constexpr std::size_t n_quantities = std::size(weather_quantities);
const std::array<WeatherColumn, n_quantities> quantities{{
    // The solar constant with the eccentricity of the orbit bounds what reaches the ground.
    {"direct normal irradiance [W/m^2]", "dni_W_m2", 0, 1412, 1},
    {"air temperature [degC]", "T_degC", -70, 65, 1},
    {"wind speed [m/s]", "wind_m_s", 0, 80, 1},
    {"relative humidity [%]", "rh_pct", 0, 110, 0.01},
    {"pressure [Pa]", "p_Pa", 40000, 110000, 1},
}};

constexpr int longest_gap = 6;  // [h]
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Number in a cell; NaN for a gap.
double number_in(std::string_view cell, std::string_view name, const std::string& place) {
  const std::string_view text = base::trim(cell);
  if (text.empty() || text == "nan" || text == "NaN" || text == "NA") return missing;
  if (const auto value = csv::number_of(text)) return *value;
  throw Error("{}: {}; expected {} here.", place, csv::why_no_number(text), name);
}

/// Collects records by hour, checks their order and range, and fills gaps.
class HourCollector {
 public:
  explicit HourCollector(std::string file) : file_(std::move(file)) {}

  /// Hour of the year from 0 and the values in the order of `quantities`, NaN for missing ones.
  void add(int hour, std::span<const double> values, int line);
  /// Checks for whole days and fills the gaps.
  WeatherHours finish();
  std::string place(int line) const { return fmt::format("{}:{}", file_, line); }

 private:
  void close_gaps(std::size_t quantity, std::vector<std::string>& warnings);
  void refuse_other_unit(std::size_t quantity) const;

  std::string file_;
  int first_hour_ = -1;
  std::array<std::vector<double>, n_quantities> columns_;
  std::vector<int> lines_;  ///< where each hour was read, or where it should have been
};

void HourCollector::add(int hour, std::span<const double> values, int line) {
  if (first_hour_ < 0) first_hour_ = hour;
  const int expected = first_hour_ + static_cast<int>(lines_.size());
  constexpr int year = hours_a_day * days_a_year;
  // A year that starts in July continues in January.
  if (hour < expected && expected >= year && hour + year - expected <= longest_gap && hour + year >= expected)
    hour += year;
  if (hour < expected)
    throw Error("{}: hour {} of the year comes after hour {}: each hour must appear once, in order.",
                place(line), hour, expected - 1);
  if (hour - expected > longest_gap)
    throw Error(
        "{}: hours {} to {} of the year are missing. Gaps of more than {} hours are not filled; complete "
        "the file or choose a period without the gap.",
        place(line), expected, hour - 1, longest_gap);
  for (int h = expected; h < hour; ++h) {
    for (auto& column : columns_) column.push_back(missing);
    lines_.push_back(line);
  }
  for (std::size_t q = 0; q < n_quantities; ++q) {
    const WeatherColumn& quantity = quantities[q];
    if (values[q] < quantity.lowest || values[q] > quantity.highest)
      throw Error("{}: the {} is {:g}; it must be from {:g} to {:g}.", place(line), quantity.name, values[q],
                  quantity.lowest, quantity.highest);
    columns_[q].push_back(values[q]);
  }
  lines_.push_back(line);
}

void HourCollector::close_gaps(std::size_t quantity, std::vector<std::string>& warnings) {
  std::vector<double>& v = columns_[quantity];
  const std::size_t n = v.size();
  for (std::size_t begin = 0; begin < n; ++begin) {
    if (!std::isnan(v[begin])) continue;
    const auto is_missing = [](double value) { return std::isnan(value); };
    const auto end =
        std::size_t(std::find_if_not(v.begin() + std::ptrdiff_t(begin), v.end(), is_missing) - v.begin());
    const std::string& what = quantities[quantity].name;
    if (end - begin > longest_gap)
      throw Error("{}: the {} is missing for {} hours from here. Gaps of more than {} hours are not filled.",
                  place(lines_[begin]), what, end - begin, longest_gap);
    // At the start or end of the file there is only one neighbor.
    const double before = begin > 0 ? v[begin - 1] : v[end];
    const double after = end < n ? v[end] : before;
    for (std::size_t i = begin; i < end; ++i)
      v[i] = before + (after - before) * double(i - begin + 1) / double(end - begin + 1);
    warnings.push_back(
        fmt::format("{}: the {} is missing for {} hour{} from here; the gap is filled linearly.",
                    place(lines_[begin]), what, end - begin, end - begin == 1 ? "" : "s"));
    begin = end;
  }
}

/// Throws Error for a column whose values are so small that they must be in another unit.
void HourCollector::refuse_other_unit(std::size_t quantity) const {
  const auto target = weather_quantities[quantity];
  const double highest = *std::max_element(columns_[quantity].begin(), columns_[quantity].end());
  // 5.1: the solar constant in MJ/m^2 per hour.
  if (target == &WeatherHours::dni && highest > 0 && highest <= 5.1)
    throw Error(
        "{}: the largest {} is {:g}: too low for the sun; expected W/m^2, not kW/m^2 or MJ/m^2 per hour.",
        file_, quantities[quantity].name, highest);
  if (target == &WeatherHours::humidity && highest > 0 && highest <= 1)
    throw Error("{}: the largest {} is {:g}: too dry for air; expected percent, not a fraction.", file_,
                quantities[quantity].name, highest);
}

WeatherHours HourCollector::finish() {
  if (lines_.empty()) throw Error("{}: this weather file contains no hours.", file_);
  if (first_hour_ % hours_a_day != 0)
    throw Error(
        "{}: the first record is hour {} of the year, but whole days are needed: it must be the first "
        "hour of a day, a multiple of {}.",
        place(lines_.front()), first_hour_, hours_a_day);
  if (lines_.size() % hours_a_day != 0)
    throw Error("{}: the file ends after {} of the 24 hours of its last day. Whole days are needed.",
                place(lines_.back()), lines_.size() % hours_a_day);
  constexpr std::size_t year = hours_a_day * days_a_year;
  const bool rotated = first_hour_ > 0 && lines_.size() == year;
  if (!rotated && first_hour_ + lines_.size() > year)
    throw Error(
        "{}: the file extends beyond hour {} of the year; a reference year has {} days (omit 29 February).",
        place(lines_.back()), year - 1, days_a_year);
  WeatherHours result;
  result.source = file_;
  result.first_day = rotated ? 0 : first_hour_ / hours_a_day;
  for (std::size_t q = 0; q < n_quantities; ++q) {
    close_gaps(q, result.warnings);
    refuse_other_unit(q);
    if (rotated)
      std::rotate(columns_[q].begin(), columns_[q].begin() + (year - first_hour_), columns_[q].end());
    for (double& value : columns_[q]) value *= quantities[q].factor;
    result.*weather_quantities[q] = std::move(columns_[q]);
  }
  return result;
}

/// Values of the lines '# name: number' above the header: time of the states, and site.
class Preamble {
 public:
  /// Reads a comment; other comments are ignored.
  void read(std::string_view comment, const std::string& place) {
    const std::size_t colon = comment.find(':');
    if (colon == std::string_view::npos) return;
    const std::string name(base::trim(comment.substr(1, colon - 1)));
    const auto known = limits_.find(name);
    if (known == limits_.end()) return;
    const double value = number_in(comment.substr(colon + 1), name, place);
    const auto [lowest, highest] = known->second;
    if (!(value >= lowest && value <= highest))
      throw Error("{}: {} is {:g}; it must be from {:g} to {:g}.", place, name, value, lowest, highest);
    values_[name] = value;
  }
  void apply(WeatherHours& record) const {
    constexpr double mid_hour = 1800;  // [s]
    const auto states = values_.find("states-at");
    record.state_offset = states == values_.end() ? mid_hour : states->second;
    if (values_.size() == (states == values_.end() ? 0 : 1)) return;
    for (const char* name : {"latitude", "longitude", "time-zone"})
      if (!values_.count(name))
        throw Error("{}: a line '# {}: ...' is missing; a location has latitude, longitude and time-zone.",
                    record.source, name);
    record.site = site_of(values_.at("latitude"), values_.at("longitude"), values_.at("time-zone"));
  }

 private:
  std::map<std::string, std::pair<double, double>> limits_{{"latitude", {-90, 90}},
                                                           {"longitude", {-180, 180}},
                                                           {"time-zone", {-14, 14}},
                                                           {"states-at", {0, 3600}}};
  std::map<std::string, double> values_;
};

/// Throws Error with the command that converts a file of another format to CSV.
[[noreturn]] void refuse_format(const std::filesystem::path& file) {
  std::string name = file.filename().string();
  for (const char* end : {".gz", ".csv", ".CSV", ".epw", ".EPW"})
    if (name.ends_with(end)) name.resize(name.size() - std::string_view(end).size());
  throw Error(
      "{0}:1: this is not the CSV of a thermocline, which has the columns hour, dni_W_m2, T_degC, "
      "wind_m_s, rh_pct and p_Pa. Files of EnergyPlus (EPW), SAM, NSRDB, TMY3 or PVGIS and other tables "
      "must be converted: couplet weather '{0}' -o '{1}'",
      file.string(), (file.parent_path() / (name + "_weather.csv")).string());
}

/// Index in `quantities` of each column of the file; n_quantities for the hour.
std::vector<std::size_t> read_head(const std::string& head, const std::filesystem::path& file,
                                   const std::string& place) {
  for (const char other : {';', '\t'})
    if (head.find(other) != std::string::npos && head.find(',') == std::string::npos)
      throw Error(
          "{}: the columns are separated by {}; a weather file needs commas, with decimal points in the "
          "numbers. 'couplet weather' converts it.",
          place, other == ';' ? "';'" : "tabs");
  std::vector<std::string> known;
  for (const WeatherColumn& q : quantities) known.push_back(q.head);
  known.emplace_back("hour");
  const std::vector<std::string> names = csv::fields(head);
  if (std::find_first_of(names.begin(), names.end(), known.begin(), known.end()) == names.end())
    refuse_format(file);
  std::vector<std::size_t> columns;
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw Error("{}: unknown column '{}'. {} 'couplet weather' converts tables with other column names.",
                  place, name.substr(0, 80), base::did_you_mean(name, known, "columns"));
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

int day_of_year(const std::string& date) {
  const auto digit = [&](std::size_t i) { return std::isdigit(static_cast<unsigned char>(date[i])) != 0; };
  if (date.size() != 5 || date[2] != '-' || !digit(0) || !digit(1) || !digit(3) || !digit(4))
    throw Error("'{}' is not a date: expected month and day as MM-DD, for example 06-01.", date);
  const int month = *csv::integer_of(date.substr(0, 2)), day = *csv::integer_of(date.substr(3));
  if (month < 1 || month > 12) throw Error("'{}' is not a date: there is no month {}.", date, month);
  const int last = days_a_month[static_cast<std::size_t>(month - 1)];
  if (day < 1 || day > last)
    throw Error("'{}' is not a date: month {} of a year of {} days has {} days.", date, month, days_a_year,
                last);
  int result = day - 1;
  for (int m = 0; m + 1 < month; ++m) result += days_a_month[static_cast<std::size_t>(m)];
  return result;
}

int month_of_day(int day) { return split_day(day).first; }

std::string date_of_day(int day) {
  const auto [month, of_month] = split_day(day);
  return fmt::format("{:02d}-{:02d}", month + 1, of_month + 1);
}

WeatherHours::Site site_of(double latitude, double longitude, double time_zone) {
  constexpr double seconds_a_degree = 240;  // the earth turns by 15 degrees an hour
  return {latitude, longitude * seconds_a_degree - 3600 * time_zone};
}

WeatherHours read_weather(const std::filesystem::path& file) {
  const std::vector<std::string> lines = csv::read_lines(file, "weather file");
  HourCollector hours(file.string());
  Preamble preamble;
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int line = static_cast<int>(i) + 1;
    const std::string_view text = base::trim(lines[i]);
    const std::string place = hours.place(line);
    if (text.starts_with('#')) preamble.read(text, place);
    if (text.empty() || text.starts_with('#')) continue;
    if (columns.empty()) {
      columns = read_head(lines[i], file, place);
      continue;
    }
    const std::vector<std::string> fields = csv::fields(lines[i]);
    for (std::size_t c = columns.size(); c < fields.size(); ++c)
      if (!fields[c].empty())
        throw Error(
            "{}: {} values, but the file has {} columns. If commas are decimal commas, use decimal points.",
            place, fields.size(), columns.size());
    if (fields.size() != columns.size())
      throw Error("{}: {} values, but the file has {} columns.", place, fields.size(), columns.size());
    std::array<double, n_quantities + 1> values;
    for (std::size_t c = 0; c < fields.size(); ++c)
      values[columns[c]] =
          number_in(fields[c], columns[c] < n_quantities ? quantities[columns[c]].name : "the hour", place);
    const double hour = values[n_quantities];
    if (!(hour >= 0 && hour < 8784 && hour == std::floor(hour)))
      throw Error(
          "{}: the hour of the year must be a whole number from 0 to 8759, not '{}'.", place,
          fields[std::size_t(std::find(columns.begin(), columns.end(), n_quantities) - columns.begin())]);
    hours.add(static_cast<int>(hour), values, line);
  }
  WeatherHours result = hours.finish();
  preamble.apply(result);
  return result;
}

}  // namespace couplet::thermocline
