// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "thermocline/weather/weather_hours.hpp"

namespace couplet::thermocline {

inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// All lines of a weather file, which may be compressed by gzip. Throws Error.
std::vector<std::string> read_lines(const std::filesystem::path& file);

/// Throws Error for a record with values beyond its last column, as decimal commas make them; empty fields may follow.
void check_width(std::span<const std::string> fields, std::size_t most, const std::string& place);

/// The number in a field of `file`:`line`; NaN if it is empty or "nan". Throws Error if it is anything else.
double number_in(const std::string& field, std::string_view name, const std::string& place);

/// Collects the records of a file hour by hour, watches over their order and range, and closes gaps.
class HourCollector {
 public:
  /// `file`: its name for messages.
  explicit HourCollector(std::string file) : file_(std::move(file)) {}

  /// Hour of the year from 0 and the five values in the order of weather_quantities, NaN for missing ones.
  void add(int hour, std::array<double, 5> values, int line);
  /// Checks that whole days are there, closes the gaps and gives the result.
  WeatherHours finish(double state_offset);

  std::string place(int line) const;

 private:
  void close_gaps(std::size_t quantity, std::vector<std::string>& warnings);

  std::string file_;
  int first_hour_ = -1;
  std::array<std::vector<double>, 5> columns_;
  std::vector<int> lines_;  ///< where each hour was read, or where it should have been
};

/// Records of one hour, averaged: files of 5 to 30 minutes have several.
class HourMean {
 public:
  explicit HourMean(HourCollector& hours) : hours_(hours) {}
  /// `minute` of the stamp: it grows from record to record of an hour. Throws Error for one that is there twice.
  void add(int hour, int minute, const std::array<double, 5>& values, int line);
  /// After the last record.
  void flush();
  bool several() const { return several_; }                   ///< records in an hour
  double mean_minute() const { return minutes_ / records_; }  ///< of all stamps

 private:
  HourCollector& hours_;
  int hour_ = -1, minute_ = 0, line_ = 0, count_ = 0;
  std::array<double, 5> sum_{};
  bool several_ = false;
  double minutes_ = 0, records_ = 0;
};

}  // namespace couplet::thermocline
