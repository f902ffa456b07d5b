// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace couplet::thermocline {

inline constexpr int hours_a_day = 24;
inline constexpr int days_a_year = 365;

/// "MM-DD" as the day of a year of 365 days, 0 for 01-01. Throws Error if it is no such date (02-29 neither:
/// a reference year has none).
int day_of_year(const std::string& date);

/// Month of a day of the year, 0 to 11.
int month_of_day(int day);

/// The inverse of day_of_year; any whole number of years may be added to `day`.
std::string date_of_day(int day);

}  // namespace couplet::thermocline
