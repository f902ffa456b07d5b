// SPDX-License-Identifier: Apache-2.0
#include "thermocline/model/model.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "common/base/error.hpp"

namespace couplet::thermocline {
namespace {

/// Empty if this temperature is plausible.
std::string forgotten_unit(const std::string& what, double kelvin_given, const Medium& fluid) {
  const double as_celsius = kelvin(kelvin_given);
  if (kelvin_given >= fluid.lowest || as_celsius < fluid.lowest || as_celsius > fluid.highest) return "";
  return fmt::format(
      "{} is {:.6g} K, that is {:.1f} degC, but {} is not a liquid below {:.0f} degC; write '{:.6g} degC' if that is intended",
      what, kelvin_given, celsius(kelvin_given), fluid.name, celsius(fluid.lowest), kelvin_given);
}

}  // namespace

std::string forgotten_unit_of_bed(const TankParameters& p) {
  const Medium fluid = make_fluid(p.fluid);
  const double unsaid = BedParameters().initial_temperature;
  for (std::size_t i = 0; i < p.bed.layers.size(); ++i)
    if (p.bed.layers[i].melting) {
      const double melts = p.bed.layers[i].melting->temperature;
      std::string found = forgotten_unit(fmt::format("layers[{}].melting.temperature", i), melts, fluid);
      if (!found.empty()) return found;
    }
  if (p.bed.profile_temperature.empty())
    return p.bed.initial_temperature == unsaid
               ? ""
               : forgotten_unit("initial-temperature", p.bed.initial_temperature, fluid);
  for (const double t : p.bed.profile_temperature)
    if (std::string found = forgotten_unit("a value of profile-temperature", t, fluid); !found.empty())
      return found;
  return "";
}

std::string forgotten_unit_of_flow(const TankParameters& p) {
  const Medium fluid = make_fluid(p.fluid);
  std::vector<std::pair<std::string, double>> given;
  if (p.flow.type == FlowParameters::Type::plant)
    given = {{"hot", p.flow.plant.hot}, {"cold", p.flow.plant.cold}};
  if (p.flow.type == FlowParameters::Type::schedule)
    for (std::size_t i = 0; i < p.flow.rows.size(); ++i) {
      const ScheduleRow& row = p.flow.rows[i];
      if (row.mass_flow != 0)
        given.emplace_back(fmt::format("rows[{}].inlet-temperature", i), row.inlet_temperature);
      if (row.stop_above) given.emplace_back(fmt::format("rows[{}].stop-above", i), *row.stop_above);
      if (row.stop_below) given.emplace_back(fmt::format("rows[{}].stop-below", i), *row.stop_below);
    }
  for (const auto& [name, value] : given)
    if (std::string found = forgotten_unit(name, value, fluid); !found.empty()) return found;
  return "";
}

std::string missing_weather(const TankParameters& p) {
  const bool plant = p.flow.type == FlowParameters::Type::plant;
  const bool deep = p.ground.has_value();
  if (p.ambient_given || !(p.insulation || p.ullage || deep || plant)) return "";
  return fmt::format("the section 'ambient' is missing, so the conditions of {} are still air of 20 degC{}.",
                     plant ? "the plant and the tank" : "the surroundings of the tank",
                     plant ? " and no sun, day and night; the field collects nothing" : " and no sun");
}

std::string restart_beyond_cut_off(const FlowParameters& flow) {
  const PlantParameters& p = flow.plant;
  if (flow.type != FlowParameters::Type::plant || p.restart <= p.cut_off) return "";
  return fmt::format(
      "flow.restart ({:g} K) is above flow.cut-off ({:g} K): a flow that may start is stopped at once, so that only the "
      "cut-off is effective.",
      p.restart, p.cut_off);
}

std::vector<std::string> prices_for_nothing(const EconomicsParameters& p, const Inventory& i, bool pump) {
  std::vector<std::string> all;
  const auto look = [&](const char* name, double price, double amount, const char* why) {
    if (price > 0 && amount == 0)
      all.push_back(fmt::format("report.economics.{} is {:g}, but has no effect: {}", name, price, why));
  };
  look("steel", p.steel, i.steel, "the tank has no section 'shell'");
  look("insulation", p.insulation, i.insulated, "the tank has no sections 'shell' and 'insulation'");
  look("filler", p.filler, i.filler, "no layer contains grains");
  look("pump", p.pump, pump ? 1 : 0, "the tank has no section 'pump'");
  return all;
}

std::string season_without_dates(const TankParameters& p) {
  if (p.flow.type != FlowParameters::Type::plant || p.ambient.kind != WeatherKind::constant) return "";
  for (std::size_t i = 0; i < p.flow.plant.calendar.size(); ++i)
    if (!p.flow.plant.calendar[i].from.empty())
      return fmt::format(
          "calendar[{}] has a season of weather dates, but the weather is constant; add 'ambient' with "
          "dates, or remove 'from' and 'to'",
          i);
  return "";
}

}  // namespace couplet::thermocline
