// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thermocline/base/clock.hpp"

namespace couplet::thermocline {
namespace {

std::string problem_of_weekday(const PlantParameters& p) {
  if (!p.start.weekday.empty() && !is_weekday(p.start.weekday))
    return fmt::format("'{}' is not a weekday: expected monday, tuesday, ... sunday", p.start.weekday);
  const bool named = std::any_of(p.calendar.begin(), p.calendar.end(),
                                 [](const CalendarRule& r) { return !r.days.empty(); });
  return named && p.start.weekday.empty()
             ? "is missing: the rules of 'calendar' name weekdays; specify the weekday of the first day"
             : "";
}

/// When charging and discharging start and stop.
void declare_control(config::Section& s, PlantParameters& p) {
  s.value("cut-off", p.cut_off)
      .unit("K difference")
      .plausible(0.1, 500)
      .positive()
      .doc(
          "charging stops when the inflow of the solar field (or the tank outlet, see cut-off-at) is this "
          "much too warm, discharging when the inflow of the power block is this much too cold");
  s.choice("cut-off-at", p.cut_off_at,
           {{"mixed", PlantParameters::CutOffAt::mixed},
            {"outlet", PlantParameters::CutOffAt::outlet},
            {"field", PlantParameters::CutOffAt::field},
            {"block", PlantParameters::CutOffAt::block}})
      .doc(
          "mixed: the cut-off applies to the inflow of field or block, where the tank's flow has been mixed "
          "with that of the other; outlet: to the tank outlet; field: mixed for charging, outlet for "
          "discharging; block: the other way round");
  s.value("restart", p.restart)
      .unit("K difference")
      .plausible(0.1, 500)
      .positive()
      .doc(
          "charging starts only if the bottom of the tank is at most this much too warm, discharging only if "
          "its top is at "
          "most this much too cold");
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
                                          : "must be smaller than the difference between 'hot' and "
                                            "'cold'.";
      },
      "cut-off");
}

}  // namespace

void declare(config::Section& s, PlantParameters& p) {
  s.value("electric-power", p.electric_power)
      .unit("W")
      .plausible(1000, 1e10)
      .positive()
      .required()
      .doc("firm output of the power block");
  s.value("block-efficiency", p.block_efficiency)
      .range(0.01, 1)
      .required()
      .doc("electric power per heat taken");
  s.value("field-area", p.field_area)
      .unit("m^2")
      .plausible(1, 1e8)
      .positive()
      .required()
      .doc("collecting area of the solar field");
  s.value("field-efficiency", p.field_efficiency)
      .range(0.01, 1)
      .required()
      .doc("heat collected per direct radiation");
  s.value("hot", p.hot)
      .unit("K")
      .plausible(70, 5000)
      .required()
      .doc("outlet temperature of the solar field and, by design, of the charged tank");
  s.value("cold", p.cold)
      .unit("K")
      .plausible(70, 5000)
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

/// The store rests: the field feeds the block with what it has, at most what the block asks for.
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
    // At the hot temperature no flow could take the heat up.
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
