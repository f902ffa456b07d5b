// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather_text.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/cells.hpp"
#include "common/csv/line_reader.hpp"
#include "thermocline/weather/weather_date.hpp"

namespace couplet::thermocline {

const std::array<WeatherQuantity, 5> weather_quantities{{
    // The solar constant with the eccentricity of the orbit bounds what reaches the ground.
    {"direct normal irradiance [W/m^2]", "dni_W_m2", 0, 1412, &WeatherHours::dni, 1},
    {"air temperature [degC]", "T_degC", -70, 65, &WeatherHours::temperature, 1},
    {"wind speed [m/s]", "wind_m_s", 0, 80, &WeatherHours::wind, 1},
    {"relative humidity [%]", "rh_pct", 0, 110, &WeatherHours::humidity, 0.01},
    {"pressure [Pa]", "p_Pa", 40000, 110000, &WeatherHours::pressure, 1},
}};

std::vector<std::string> read_lines(const std::filesystem::path& file) {
  return csv::read_lines(file, "weather file");
}

double number_in(const std::string& field, std::string_view name, const std::string& place) {
  const std::string_view text = base::trim(field);
  if (text.empty() || text == "nan" || text == "NaN" || text == "NA") return missing;
  if (const auto value = csv::number_of(text)) return *value;
  throw Error("{}: {}; expected {} here.", place, csv::why_no_number(text), name);
}

void check_width(std::span<const std::string> fields, std::size_t most, const std::string& place) {
  for (std::size_t i = most; i < fields.size(); ++i)
    if (!base::trim(fields[i]).empty())
      throw Error(
          "{}: {} values, but the file has {} columns. If commas are decimal commas, use decimal points.",
          place, fields.size(), most);
}

std::string HourCollector::place(int line) const { return fmt::format("{}:{}", file_, line); }

void HourCollector::add(int hour, std::array<double, 5> values, int line) {
  if (first_hour_ < 0) first_hour_ = hour;
  const int expected = first_hour_ + static_cast<int>(lines_.size());
  constexpr int year = hours_a_day * days_a_year;
  // A year that begins in July goes on in January.
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
  for (std::size_t q = 0; q < values.size(); ++q) {
    const WeatherQuantity& quantity = weather_quantities[q];
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
    std::size_t end = begin;
    while (end < n && std::isnan(v[end])) ++end;
    const std::string what(weather_quantities[quantity].name);
    if (end - begin > longest_gap)
      throw Error("{}: the {} is missing for {} hours from here. Gaps of more than {} hours are not filled.",
                  place(lines_[begin]), what, end - begin, longest_gap);
    // At the start or the end of the file there is one neighbour only.
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

void HourMean::add(int hour, int minute, const std::array<double, 5>& values, int line) {
  if (hour != hour_)
    flush();
  else if (minute <= minute_)
    throw Error(
        "{}: minute {} of hour {} of the year comes after minute {}: each record must appear once, in order.",
        hours_.place(line), minute, hour, minute_);
  several_ = several_ || count_ > 0;
  hour_ = hour, minute_ = minute, line_ = line, ++count_;
  minutes_ += minute, ++records_;
  for (std::size_t q = 0; q < values.size(); ++q) sum_[q] += values[q];
}

void HourMean::flush() {
  if (count_ == 0) return;
  for (double& s : sum_) s /= count_;
  hours_.add(hour_, sum_, line_);
  hour_ = -1, count_ = 0, sum_ = {};
}

namespace {

/// A column that is all too small has another unit than the one that is read.
void refuse_other_unit(const std::string& file, const WeatherQuantity& quantity, double highest, double least,
                       const char* other) {
  if (highest > 0 && highest <= least)
    throw Error("{}: the largest {} is {:g}: {}", file, quantity.name, highest, other);
}

}  // namespace

WeatherHours HourCollector::finish(double state_offset) {
  if (lines_.empty()) throw Error("{}: this weather file contains no hours.", file_);
  if (first_hour_ % hours_a_day != 0)
    throw Error(
        "{}: the first record is hour {} of the year, but whole days are needed: it must be the first hour "
        "of a day, a multiple of {}.",
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
  result.state_offset = state_offset;
  for (std::size_t q = 0; q < columns_.size(); ++q) {
    close_gaps(q, result.warnings);
    if (rotated)
      std::rotate(columns_[q].begin(), columns_[q].begin() + (year - first_hour_), columns_[q].end());
    const double highest = *std::max_element(columns_[q].begin(), columns_[q].end());
    const WeatherQuantity& quantity = weather_quantities[q];
    if (quantity.target == &WeatherHours::dni)
      refuse_other_unit(file_, quantity, highest, 5.1,  // the solar constant in MJ/m^2 an hour
                        "too low for the sun; expected W/m^2, not kW/m^2 or MJ/m^2 per hour.");
    if (quantity.target == &WeatherHours::humidity)
      refuse_other_unit(file_, quantity, highest, 1, "too dry for air; expected percent, not a fraction.");
    for (double& value : columns_[q]) value *= weather_quantities[q].factor;
    result.*weather_quantities[q].target = std::move(columns_[q]);
  }
  return result;
}

}  // namespace couplet::thermocline
