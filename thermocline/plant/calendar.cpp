// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/calendar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "thermocline/base/clock.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::thermocline {
namespace {

constexpr unsigned all_days = 0x7f, working_days = 0x1f, weekend = 0x60;
const std::array<std::string, 7> weekday_names{"monday", "tuesday",  "wednesday", "thursday",
                                               "friday", "saturday", "sunday"};

int number_of_weekday(const std::string& name) {
  return int(std::find(weekday_names.begin(), weekday_names.end(), name) - weekday_names.begin());
}

/// Of `weekdays`, `weekend` or one day; 0 for what is none of them.
unsigned bits_of(const std::string& name) {
  if (name == "weekdays") return working_days;
  if (name == "weekend") return weekend;
  return is_weekday(name) ? 1u << number_of_weekday(name) : 0;
}

std::string problem_of_days(const std::vector<std::string>& days) {
  std::vector<std::string> known(weekday_names.begin(), weekday_names.end());
  known.insert(known.end(), {"weekdays", "weekend"});
  for (const std::string& day : days)
    if (bits_of(day) == 0) return fmt::format("'{}' is not one of: {}", day, base::join(known));
  return "";
}

std::string problem_of_season(const CalendarRule& rule) {
  if (rule.from.empty() != rule.to.empty())
    return fmt::format("a season needs 'from' and 'to'; '{}' is missing", rule.from.empty() ? "from" : "to");
  try {
    if (!rule.from.empty()) day_of_year(rule.from), day_of_year(rule.to);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

long day_of(double t) { return long(std::floor((t / seconds_an_hour + clock_rounding) / hours_a_day)); }

long positive_rest(long value, long of) { return (value % of + of) % of; }

}  // namespace

bool is_weekday(const std::string& name) { return number_of_weekday(name) < int(weekday_names.size()); }

double at_hour(const std::vector<double>& values, double t) {
  if (values.size() == 1) return values.front();
  const double clock = std::floor(t / seconds_an_hour + clock_rounding);
  return values[std::size_t(clock - hours_a_day * std::floor(clock / hours_a_day))];
}

std::string problem_of_day(const std::vector<double>& values, bool share) {
  if (values.size() != 1 && values.size() != std::size_t(hours_a_day))
    return fmt::format("has {} values; give one, or 24 for the hours of the day from 00:00 on",
                       values.size());
  for (const double v : values)
    if (share && !(v >= 0 && v <= 1))
      return fmt::format(
          "{:g} is not a valid share of the load; expected 0 "
          "to 1",
          v);
  return "";
}

void declare(config::Section& s, CalendarRule& r) {
  s.value("days", r.days)
      .doc("names of weekdays in English, or weekdays (monday to friday), weekend; absent: every day");
  s.value("from", r.from).doc("first day of the season, MM-DD of the weather; absent: all year");
  s.value("to", r.to).doc("its last day, MM-DD; it may lie in the next year");
  s.value("load", r.load).doc("share of electric-power, one value or 24");
  s.value("tariff", r.tariff).doc("electricity price per MWh, one value or 24");
  s.check([&r] { return problem_of_days(r.days); }, "days");
  s.check([&r] { return problem_of_season(r); }, r.from.empty() ? "to" : "from");
  s.check([&r] { return r.load.empty() ? "" : problem_of_day(r.load, true); }, "load");
  s.check([&r] { return r.tariff.empty() ? "" : problem_of_day(r.tariff, false); }, "tariff");
  s.check([&r] { return r.load.empty() && r.tariff.empty() ? "a rule needs a load or a tariff" : ""; }, "");
}

Calendar::Calendar(const std::vector<CalendarRule>& rules, const CalendarStart& start)
    : weekday_(is_weekday(start.weekday) ? number_of_weekday(start.weekday) : 0),
      day_(start.day),
      period_(start.period) {
  for (const CalendarRule& given : rules) {
    Rule rule;
    for (const std::string& day : given.days) rule.weekdays |= bits_of(day);
    if (given.days.empty()) rule.weekdays = all_days;
    rule.has_season = !given.from.empty();
    if (rule.has_season) rule.from = day_of_year(given.from), rule.to = day_of_year(given.to);
    rule.load = given.load, rule.tariff = given.tariff;
    rules_.push_back(std::move(rule));
  }
}

bool Calendar::holds(const Rule& rule, long day) const {
  if ((rule.weekdays >> positive_rest(weekday_ + day, 7) & 1u) == 0) return false;
  if (!rule.has_season) return true;
  const int date = int((day_ + positive_rest(day, period_)) % days_a_year);
  return rule.from <= rule.to ? date >= rule.from && date <= rule.to : date >= rule.from || date <= rule.to;
}

const Calendar::Rule* Calendar::first(long day, std::vector<double> Rule::*values) const {
  for (const Rule& rule : rules_)
    if (!(rule.*values).empty() && holds(rule, day)) return &rule;
  return nullptr;
}

const std::vector<double>* Calendar::load(double t) const {
  const Rule* rule = first(day_of(t), &Rule::load);
  return rule ? &rule->load : nullptr;
}

const std::vector<double>* Calendar::tariff(double t) const {
  const Rule* rule = first(day_of(t), &Rule::tariff);
  return rule ? &rule->tariff : nullptr;
}

std::vector<std::string> Calendar::doubts() const {
  constexpr long until_all_repeats = 7L * days_a_year;  // each date has been each weekday
  std::vector<bool> used(rules_.size(), false);
  for (long day = 0; day < until_all_repeats; ++day)
    for (const auto values : {&Rule::load, &Rule::tariff})
      if (const Rule* rule = first(day, values)) used[std::size_t(rule - rules_.data())] = true;
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < rules_.size(); ++i)
    if (!used[i])
      sentences.push_back(fmt::format(
          "flow.calendar[{}] applies on no day: the weather does not contain its days, or earlier rules "
          "override it",
          i));
  return sentences;
}

}  // namespace couplet::thermocline
