// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/config/section.hpp"

/// Load and tariff that follow weekday and season.
namespace couplet::thermocline {

/// On which days which load and tariff hold: one value, or 24 for the hours.
struct CalendarRule {
  std::vector<std::string> days;  ///< monday ... sunday, weekdays, weekend; empty: all of them
  std::string from, to;           ///< MM-DD, both inclusive; `to` may lie in the next year; empty: all year
  std::vector<double> load, tariff;
};
void declare(config::Section& section, CalendarRule& rule);

/// What the calendar has to know of the run.
struct CalendarStart {
  std::string weekday;  ///< of the first day; needed where a rule names weekdays
  int day = 0;          ///< first day of the weather, 0 for 01-01
  int period = 365;     ///< days after which the weather begins again with that day
};

/// Empty, or what is wrong with values of a day: neither one nor 24, or (of a load) no share.
std::string problem_of_day(const std::vector<double>& values, bool share);
/// The value of the hour in which t lies [s].
double at_hour(const std::vector<double>& values, double t);
/// Whether this is the name of a weekday.
bool is_weekday(const std::string& name);

/// Of several rules that hold, the first one that gives a load (a tariff) counts. Seasons follow the date of the
/// weather, which may go round; weekdays go on evenly, a year of 365 days after the other.
class Calendar {
 public:
  Calendar(const std::vector<CalendarRule>& rules, const CalendarStart& start);

  /// Values of the day in which t lies [s]; nullptr where no rule gives any.
  const std::vector<double>* load(double t) const;
  const std::vector<double>* tariff(double t) const;
  /// Rules that give nothing on any day, however long the run. Sentences.
  std::vector<std::string> doubts() const;

 private:
  struct Rule {
    unsigned weekdays = 0;  ///< bit 0: monday
    bool has_season = false;
    int from = 0, to = 0;  ///< days of the year
    std::vector<double> load, tariff;
  };
  bool holds(const Rule& rule, long day) const;
  const Rule* first(long day, std::vector<double> Rule::*values) const;

  std::vector<Rule> rules_;
  int weekday_, day_, period_;
};

}  // namespace couplet::thermocline
