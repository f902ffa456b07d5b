// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/plant.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::thermocline {
namespace {

constexpr unsigned all_days = 0x7f, working_days = 0x1f, weekend = 0x60;
const std::array<std::string, 7> weekday_names{"monday", "tuesday",  "wednesday", "thursday",
                                               "friday", "saturday", "sunday"};

int number_of_weekday(const std::string& name) {
  return int(std::find(weekday_names.begin(), weekday_names.end(), name) - weekday_names.begin());
}

/// Bits of `weekdays`, `weekend` or one day; 0 for any other name.
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

std::string problem_of_weekday(const PlantParameters& p) {
  if (!p.start.weekday.empty() && !is_weekday(p.start.weekday))
    return fmt::format("'{}' is not a weekday: expected monday, tuesday, ... sunday", p.start.weekday);
  const bool named = std::any_of(p.calendar.begin(), p.calendar.end(),
                                 [](const CalendarRule& r) { return !r.days.empty(); });
  return named && p.start.weekday.empty()
             ? "is missing: the rules of 'calendar' name weekdays; specify the weekday of the first day"
             : "";
}

/// Declares when charging and discharging start and stop.
void declare_control(config::Section& s, PlantParameters& p) {
  as_difference(s.value("cut-off", p.cut_off))
      .positive()
      .doc(
          "charging stops when the inlet of the solar field (or the tank outlet, see cut-off-at) is warmer than 'cold' by this "
          "much, and discharging when the inlet of the power block is colder than 'hot' by this much");
  s.choice("cut-off-at", p.cut_off_at,
           {{"mixed", PlantParameters::CutOffAt::mixed},
            {"outlet", PlantParameters::CutOffAt::outlet},
            {"field", PlantParameters::CutOffAt::field},
            {"block", PlantParameters::CutOffAt::block}})
      .doc(
          "mixed: the cut-off applies to the temperature at the inlet of the solar field or power block, after the tank's flow "
          "has mixed with the flow from the other one. outlet: it applies to the temperature at the tank outlet. field: as "
          "'mixed' for charging and as 'outlet' for discharging. block: the other way round");
  as_difference(s.value("restart", p.restart))
      .positive()
      .doc(
          "charging starts only if the bottom of the tank is at most this much warmer than 'cold', and discharging only if its "
          "top is at most this much colder than 'hot'");
}

void check_plant(config::Section& s, const PlantParameters& p) {
  s.check([&p] { return problem_of_day(p.load, true); }, "load");
  s.check([&p] { return p.tariff.empty() ? "" : problem_of_day(p.tariff, false); }, "tariff");
  s.check([&p] { return problem_of_weekday(p); }, "first-weekday");
  s.check(
      [&p] {
        const bool priced = std::any_of(p.calendar.begin(), p.calendar.end(),
                                        [](const CalendarRule& r) { return !r.tariff.empty(); });
        return priced && p.tariff.empty() ? "is needed for the hours without a price in any rule of "
                                            "'calendar'"
                                          : "";
      },
      "tariff");
  s.check([&p] { return p.hot > p.cold ? "" : "'hot' must be above 'cold'."; }, "hot");
  s.check(
      [&p] {
        return p.cut_off < p.hot - p.cold ? ""
                                          : "must be smaller than the difference between 'hot' and 'cold'.";
      },
      "cut-off");
}

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
      return fmt::format("{:g} is not a valid share of the load; expected 0 to 1", v);
  return "";
}

void declare(config::Section& s, CalendarRule& r) {
  s.value("days", r.days)
      .doc("names of weekdays in English, or 'weekdays' (monday to friday) or 'weekend'; default: every day");
  s.value("from", r.from).doc("first day of the season, MM-DD of the weather; default: all year");
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
          "flow.calendar[{}] applies on no day: the weather does not contain its days, or earlier rules override it",
          i));
  return sentences;
}

void declare(config::Section& s, PlantParameters& p) {
  s.value("electric-power", p.electric_power)
      .unit("W", 1000, 1e10)
      .positive()
      .required()
      .doc("firm output of the power block");
  s.value("block-efficiency", p.block_efficiency)
      .range(0.01, 1)
      .required()
      .doc("efficiency: electric power per heat taken");
  s.value("field-area", p.field_area)
      .unit("m^2", 1, 1e8)
      .positive()
      .required()
      .doc("collecting area of the solar field");
  s.value("field-efficiency", p.field_efficiency)
      .range(0.01, 1)
      .required()
      .doc("collected heat per direct irradiation of the field");
  as_temperature(s.value("hot", p.hot))
      .required()
      .doc("outlet temperature of the solar field and, by design, of the charged tank");
  as_temperature(s.value("cold", p.cold))
      .required()
      .doc("outlet temperature of the power block and, by design, of the discharged tank");
  declare_control(s, p);
  s.value("load", p.load)
      .doc("requested share of electric-power, one value or 24 for the hours of the day from 00:00");
  s.value("tariff", p.tariff)
      .doc("electricity price per MWh, one value or 24; with it the report includes the revenue");
  s.value("first-weekday", p.start.weekday)
      .doc("weekday of the first day, monday to sunday; needed where a rule of 'calendar' names weekdays");
  s.list<CalendarRule>(
      "calendar", p.calendar, [](config::Section& q, CalendarRule& r) { declare(q, r); },
      "days with another load or tariff; the first matching rule applies");
  check_plant(s, p);
}

Plant::Plant(const PlantParameters& parameters, double specific_heat)
    : p_(parameters), calendar_(parameters.calendar, parameters.start), c_(specific_heat) {}

double Plant::field_heat(double irradiance) const { return irradiance * p_.field_area * p_.field_efficiency; }

double Plant::block_heat() const { return p_.electric_power / p_.block_efficiency; }

double Plant::load(double t) const {
  const std::vector<double>* today = calendar_.load(t);
  return at_hour(today ? *today : p_.load, t);
}
double Plant::tariff(double t) const {
  if (p_.tariff.empty()) return 0;
  const std::vector<double>* today = calendar_.tariff(t);
  return at_hour(today ? *today : p_.tariff, t);
}
double Plant::load_until(double t) const {
  if (p_.load.size() < 2 && p_.tariff.size() < 2 && p_.calendar.empty())
    return std::numeric_limits<double>::infinity();
  return (std::floor(t / seconds_an_hour + clock_rounding) + 1) * seconds_an_hour;
}

/// The tank rests. The field supplies the block up to its demand.
PlantFlows Plant::idle(double field_heat, double load) const {
  PlantFlows f;
  f.field_heat = field_heat;
  f.block_heat = block_heat() * load;
  f.field_flow = std::min(field_heat, f.block_heat) / (c_ * (p_.hot - p_.cold));
  f.block_flow = f.block_heat / (c_ * (p_.hot - p_.cold));
  f.field_inlet = p_.cold;
  f.block_inlet = p_.hot;
  return f;
}

PlantFlows Plant::charge(double field_heat, double bottom, double load) const {
  PlantFlows f = idle(field_heat, load);
  f.mode = PlantMode::charge;
  const double m = (field_heat - f.block_heat) / (c_ * (p_.hot - bottom));
  f.tank_flow = -m;
  f.field_flow = f.block_flow + m;
  f.field_inlet = (f.block_flow * p_.cold + m * bottom) / f.field_flow;  // (5.5)
  return f;
}

PlantFlows Plant::discharge(double field_heat, double top, double load) const {
  PlantFlows f = idle(field_heat, load);
  f.mode = PlantMode::discharge;
  const double m = (f.block_heat - field_heat) / (c_ * (top - p_.cold));
  f.tank_flow = m;
  f.block_flow = f.field_flow + m;
  f.block_inlet = (f.field_flow * p_.hot + m * top) / f.block_flow;  // (5.6)
  return f;
}

PlantFlows Plant::flows(double field_heat, double top, double bottom, PlantMode before, double load) const {
  const double block = block_heat() * load;
  using CutOffAt = PlantParameters::CutOffAt;
  const CutOffAt at = p_.cut_off_at;
  if (field_heat > block) {
    const double start = before == PlantMode::charge ? p_.hot : p_.cold + p_.restart;
    // At the hot temperature no flow can take up the heat.
    if (bottom > start || bottom >= p_.hot) return idle(field_heat, load);
    const PlantFlows f = charge(field_heat, bottom, load);
    return (at == CutOffAt::outlet || at == CutOffAt::block ? bottom : f.field_inlet) < p_.cold + p_.cut_off
               ? f
               : idle(field_heat, load);
  }
  if (field_heat < block) {
    const double start = before == PlantMode::discharge ? p_.cold : p_.hot - p_.restart;
    if (top < start || top <= p_.cold) return idle(field_heat, load);
    const PlantFlows f = discharge(field_heat, top, load);
    return (at == CutOffAt::outlet || at == CutOffAt::field ? top : f.block_inlet) > p_.hot - p_.cut_off
               ? f
               : idle(field_heat, load);
  }
  return idle(field_heat, load);
}

}  // namespace couplet::thermocline
