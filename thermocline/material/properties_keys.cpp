// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {
namespace {

void nothing(config::Section&) {}

/// Returns why a column beside `temperature` is not valid, or nothing.
std::string problem_of(const std::vector<double>& temperature, const std::vector<double>& values,
                       bool positive) {
  if (temperature.empty()) return "'temperature' is empty; give the temperatures of the values";
  if (std::adjacent_find(temperature.begin(), temperature.end(), std::greater_equal<>()) != temperature.end())
    return "'temperature' must increase from value to value";
  if (values.size() != temperature.size())
    return fmt::format("has {} values, 'temperature' has {}", values.size(), temperature.size());
  if (positive && *std::min_element(values.begin(), values.end()) <= 0) return "must be above 0 everywhere";
  return "";
}

/// Usual magnitudes of the properties that are tables.
std::pair<double, double> usual_of(std::string_view unit) {
  if (unit == "W/(m K)") return {1e-3, 1e7};
  if (unit == "J/(kg K)") return {10, 1e5};
  if (unit == "1/K") return {1e-8, 1e-3};
  if (unit == "Pa s") return {1e-6, 1e3};
  return {1e6, 2e12};  // strength and modulus of metals [Pa]
}

void declare_table(config::Section& s, const char* name, const char* unit, std::vector<double>& values,
                   const std::vector<double>& temperature, const char* doc) {
  s.value(name, values).unit(unit).plausible(usual_of(unit).first, usual_of(unit).second).required().doc(doc);
  s.check([&] { return problem_of(temperature, values, true); }, name);
}

/// A fluid of constants and lists.
void declare_custom(config::Section& s, FluidParameters& p) {
  as_density(s.value("density", p.density)).positive().required().doc("density, a constant");
  as_specific_heat(s.value("specific-heat", p.specific_heat)).positive().required().doc("a constant");
  as_temperature(s.value("temperature", p.temperature)).required().doc("temperatures of the following lists");
  declare_table(s, "conductivity", "W/(m K)", p.conductivity, p.temperature, "piecewise linear");
  declare_table(s, "viscosity", "Pa s", p.viscosity, p.temperature, "piecewise linear");
  as_temperature(s.value("lowest", p.lowest)).doc("freezing point: below it a warning");
  s.value("highest", p.highest)
      .unit("K")
      .plausible(70, 1e4)
      .doc("boiling or decomposition point: above it a warning");
}

}  // namespace

void declare(config::Section& section, FluidParameters& p) {
  using Type = FluidParameters::Type;
  const auto known = [&p](config::Section& s) {
    s.value("real-density", p.real_density)
        .doc(
            "the density falls with temperature, in the heat of the pores and in the pressure on the "
            "wall; otherwise it is the constant of thesis table 5.1");
  };
  const auto gas = [&p](config::Section& s) {
    s.value("pressure", p.pressure)
        .unit("Pa")
        .plausible(1e4, 1e8)
        .positive()
        .doc("pressure where the gas leaves the bed");
    s.value("reference-temperature", p.reference_temperature)
        .unit("K")
        .range(150, 1500)
        .doc(
            "temperature of the density used for the heat in the pores; the pressure loss uses the "
            "actual temperature");
    s.value("specific-heat", p.air_specific_heat)
        .unit("J/(kg K)")
        .range(900, 1400)
        .doc(
            "constant; the default is that of air near 430 degC (it is 1007 at 50 degC, 1141 at 730 "
            "degC); the run judges it");
  };
  section.variant<Type>("type", p.type,
                        {{"solar-salt", Type::solar_salt, known},
                         {"caloria-ht43", Type::caloria_ht43, known},
                         {"air", Type::air, gas},
                         {"custom", Type::custom, [&p](config::Section& s) { declare_custom(s, p); }}},
                        "60 % NaNO3 + 40 % KNO3, the oil of Solar One, dry air (with bed.advection: "
                        "implicit), or the values given here",
                        true);
}

void declare(config::Section& s, Filler& f) {
  as_density(s.value("density", f.density))
      .positive()
      .doc("density of the grains; the defaults are those of quartzite");
  as_specific_heat(s.value("specific-heat", f.specific_heat)).positive().doc("specific heat of the grains");
  as_conductivity(s.value("conductivity", f.conductivity)).positive().doc("conductivity of the grains");
  s.value("friction-angle", f.friction_angle)
      .unit("rad")
      .range(0.01, 1.5)
      .doc("internal friction angle of the bulk, phi in (5.17)");
  s.value("expansion", f.expansion)
      .unit("1/K")
      .plausible(1e-8, 1e-3)
      .not_negative()
      .doc("linear thermal expansion of the bulk");
}

void declare(config::Section& s, Melting& m) {
  as_temperature(s.value("temperature", m.temperature))
      .positive()
      .required()
      .doc("middle of the melting range");
  s.value("width", m.width).unit("K difference").range(1e-3, 200).doc("width of that range");
  s.value("latent-heat", m.latent_heat)
      .unit("J/kg")
      .plausible(1000, 1e7)
      .not_negative()
      .required()
      .doc("latent heat, absorbed evenly over the range");
}

void declare(config::Section& section, SteelParameters& p) {
  using Type = SteelParameters::Type;
  const auto custom = [&p](config::Section& s) {
    as_density(s.value("density", p.density)).positive().doc("density");
    s.value("poissons-ratio", p.poissons_ratio).range(0, 0.499).doc("Poisson's ratio");
    s.value("highest", p.highest)
        .unit("K")
        .plausible(70, 1e4)
        .doc("maximum service temperature of the metal: above it a warning");
    as_temperature(s.value("temperature", p.temperature))
        .required()
        .doc("temperatures of the following lists");
    declare_table(s, "specific-heat", "J/(kg K)", p.specific_heat, p.temperature, "piecewise linear");
    declare_table(s, "conductivity", "W/(m K)", p.conductivity, p.temperature, "piecewise linear");
    declare_table(s, "youngs-modulus", "Pa", p.youngs_modulus, p.temperature, "piecewise linear");
    declare_table(s, "expansion", "1/K", p.expansion, p.temperature,
                  "instantaneous coefficient, integrated over temperature");
    declare_table(s, "yield-strength", "Pa", p.yield_strength, p.temperature, "piecewise linear");
  };
  section.variant<Type>("type", p.type,
                        {{"a537-class-2", Type::a537, nothing},
                         {"a387-grade-91", Type::a387, nothing},
                         {"n06022", Type::n06022, nothing},
                         {"custom", Type::custom, custom}},
                        "a metal of thesis table 5.1, or the values given here", true);
}

void declare(config::Section& s, InsulatorParameters& p) {
  as_density(s.value("density", p.density)).positive().doc("density");
  as_specific_heat(s.value("specific-heat", p.specific_heat)).positive().doc("specific heat");
  as_temperature(s.value("temperature", p.temperature))
      .doc("temperatures of 'conductivity'; absent for a constant");
  as_conductivity(s.value("conductivity", p.conductivity))
      .doc("piecewise linear; absent: a wired mineral-wool mat, 0.040 at 50 degC to 0.163 at 500 degC");
  s.check(
      [&]() -> std::string {
        if (p.conductivity.empty() && p.temperature.empty()) return "";
        if (p.temperature.empty())
          return p.conductivity.size() == 1 ? "" : "requires 'temperature', unless it is one constant";
        return problem_of(p.temperature, p.conductivity, true);
      },
      "conductivity");
}

}  // namespace couplet::thermocline
