// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather_date.hpp"

#include <array>
#include <cctype>

#include "common/base/error.hpp"
#include "common/csv/cells.hpp"

namespace couplet::thermocline {
namespace {

constexpr std::array<int, 12> days_a_month{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};

struct MonthAndDay {
  int month, day;  ///< from 0
};
MonthAndDay split_day(int day) {
  day = (day % days_a_year + days_a_year) % days_a_year;
  std::size_t month = 0;
  while (day >= days_a_month[month]) day -= days_a_month[month++];
  return {static_cast<int>(month), day};
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

int month_of_day(int day) { return split_day(day).month; }

std::string date_of_day(int day) {
  const MonthAndDay d = split_day(day);
  return fmt::format("{:02d}-{:02d}", d.month + 1, d.day + 1);
}

}  // namespace couplet::thermocline
