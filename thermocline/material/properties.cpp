// SPDX-License-Identifier: Apache-2.0
#include "thermocline/material/properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace couplet::thermocline {

namespace {

Steel steel(std::string name, double density, std::vector<double> range, std::vector<double> cp,
            std::vector<double> k, std::vector<double> e, std::vector<double> alpha,
            std::vector<double> yield, double highest) {
  const auto table = [&](const std::vector<double>& y) { return Curve(range, y); };
  return {std::move(name), density, 0.3, table(cp), table(k), table(e), table(alpha), table(yield), highest};
}

const std::map<std::string, Insulator>& foundations() {
  // Handbook values (Incropera, tables A.3 and A.1, and data sheets); the conductivity of cellular glass
  // increases with temperature.
  static const std::map<std::string, Insulator> all{
      {"steel-plate", {7850, 480, 50.0}},
      {"dry-sand", {1515, 800, 0.27}},
      {"foam-glass", {145, 1000, Curve({298.15, 573.15}, {0.058, 0.10})}},
      {"hard-firebrick", {2050, 960, 1.2}},
      {"insulating-firebrick", {600, 960, 0.20}},
      {"insulating-concrete", {800, 960, 0.25}},
      {"concrete", {2300, 880, 1.4}},
      {"soil", {2050, 1840, 1.2}},
  };
  return all;
}

}  // namespace

Medium solar_salt() {
  // Table 5.1 gives the conductivity in kW with a slope ten times too small, and -1.24e-4 in the viscosity,
  // which is then negative above 407 degC. These are the correlations of Zavoico (SAND2001-2100). Density and
  // specific heat are those at 340 degC, which reproduce table 5.3.
  return {"solar salt",
          1873.8,
          1501.5,
          [](double t) { return 0.443 + 1.9e-4 * celsius(t); },
          [](double t) {
            const double c = celsius(t);
            return 2.2714e-2 + c * (-1.20e-4 + c * (2.281e-7 - c * 1.474e-10));
          },
          zero_celsius + 238,
          zero_celsius + 600,
          DensityLaw{2090, -0.636, 0}};
}

Medium caloria_ht43() {
  // Table 5.1 gives the conductivity in kW/(m K); its density is that of the fit at 280 degC.
  return {"Caloria HT-43",
          692.4,
          2700,
          [](double t) { return 0.125 - 1.4e-4 * celsius(t); },
          [](double t) { return 132.73 * std::pow(std::max(celsius(t), 20.0), -2.207); },
          zero_celsius - 10,
          zero_celsius + 315,
          DensityLaw{885, -0.6617, -1.265e-4}};
}

double air_heat_between(double from, double to) {
  // c_p/R of dry air, 300 to 1000 K, within 0.1 % there [moran2014, table A-21]; held constant beyond.
  constexpr double r = 287.05, lowest = 300, highest = 1000;
  constexpr double a[] = {3.653, -1.337e-3, 3.294e-6, -1.913e-9, 0.2763e-12};
  const auto capacity = [&](double t) {
    return r * (a[0] + t * (a[1] + t * (a[2] + t * (a[3] + t * a[4]))));
  };
  const auto integral = [&](double t) {
    return r * t * (a[0] + t * (a[1] / 2 + t * (a[2] / 3 + t * (a[3] / 4 + t * a[4] / 5))));
  };
  const auto heat = [&](double t) {  // above `lowest`
    const double within = std::clamp(t, lowest, highest);
    return integral(within) - integral(lowest) + capacity(within) * (t - within);
  };
  return heat(to) - heat(from);
}

double air_conductivity(double t) { return 0.0241 * std::pow(t / 273.15, 1.5) * (273.15 + 194) / (t + 194); }
double air_viscosity(double t) {
  return 1.716e-5 * std::pow(t / 273.15, 1.5) * (273.15 + 110.4) / (t + 110.4);
}

Medium air_at(double pressure, double reference_temperature, double specific_heat) {
  constexpr double gas_constant = 287.05;
  Medium air{"air",         pressure / (gas_constant * reference_temperature),
             specific_heat, air_conductivity,
             air_viscosity, 150,
             1500};
  air.gas_constant = gas_constant, air.pressure = pressure;
  return air;
}

Steel steel_a537() {
  return steel("A537 class 2", 7850, {477, 577}, {512, 547}, {53.5, 49}, {1.92e11, 1.84e11},
               {1.39e-5, 1.49e-5}, {3.11e8, 2.82e8}, zero_celsius + 371);
}
Steel steel_a387() {
  return steel("A387 grade 91", 7850, {563, 663}, {541, 600}, {27.3, 27.8}, {1.95e11, 1.88e11},
               {1.26e-5, 1.32e-5}, {3.76e8, 3.61e8}, zero_celsius + 649);
}
Steel nickel_n06022() {
  // Table 5.1's highest temperature, 1250, is in degF.
  return steel("N06022", 8691, {563, 838}, {482, 532}, {15.2, 20.8}, {1.91e11, 1.75e11}, {1.32e-5, 1.74e-5},
               {2.16e8, 1.88e8}, zero_celsius + 677);
}

Insulator mineral_wool() {
  return {
      100, 840,
      Curve({323.15, 373.15, 473.15, 573.15, 673.15, 773.15}, {0.040, 0.047, 0.066, 0.091, 0.123, 0.163})};
}

Insulator foundation_material(const std::string& name) { return foundations().at(name); }

std::vector<std::string> foundation_materials() {
  std::vector<std::string> names;
  for (const auto& [name, material] : foundations()) names.push_back(name);
  return names;
}

Medium make_fluid(const MediumInput& p) {
  if (p.type == MediumInput::Type::air)
    return air_at(p.pressure, p.reference_temperature, p.air_specific_heat);
  if (p.type != MediumInput::Type::custom) {
    Medium known = p.type == MediumInput::Type::solar_salt ? solar_salt() : caloria_ht43();
    known.real_density = p.real_density;
    return known;
  }
  Medium own{"fluid", p.density, p.specific_heat, Curve(p.temperature, p.conductivity),
             Curve(p.temperature, p.viscosity)};
  if (p.temperature.size() > 1) own.known_from = p.temperature.front(), own.known_to = p.temperature.back();
  return own;
}

Steel make_steel(const SteelParameters& p) {
  using Type = SteelParameters::Type;
  if (p.type == Type::a537) return steel_a537();
  if (p.type == Type::a387) return steel_a387();
  if (p.type == Type::n06022) return nickel_n06022();
  Steel made = steel("shell metal", p.density, p.temperature, p.specific_heat, p.conductivity,
                     p.youngs_modulus, p.expansion, p.yield_strength, p.temperature.back());
  made.poissons_ratio = p.poissons_ratio;
  return made;
}

Insulator make_insulator(const InsulatorParameters& p) {
  Insulator made = mineral_wool();
  made.density = p.density;
  made.specific_heat = p.specific_heat;
  if (!p.conductivity.empty())
    made.conductivity =
        p.temperature.empty() ? Curve(p.conductivity[0]) : Curve(p.temperature, p.conductivity);
  return made;
}

Filler make_filler(const FillerParameters& p) {
  return {p.density,
          {p.specific_heat, "filler.specific-heat"},
          {p.conductivity, "filler.conductivity"},
          p.friction_angle,
          p.expansion,
          p.emissivity};
}

GrainHeat::GrainHeat(const Filler& filler, const std::optional<Melting>& melting) {
  std::vector<double> nodes;
  if (const fv::Table* table = filler.specific_heat.table()) nodes = table->at();
  double low = 0, high = 0, latent = 0;  // of the melting range
  if (melting) {
    low = melting->temperature - melting->width / 2, high = melting->temperature + melting->width / 2;
    latent = filler.density * melting->latent_heat / (high - low);
    nodes.push_back(low), nodes.push_back(high);
  }
  if (nodes.empty()) nodes.push_back(zero_celsius);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  pieces_.push_back({nodes.front(), 0, filler.volumetric(nodes.front()), 0});
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double from = nodes[i], c = filler.volumetric(from) + (from >= low && from < high ? latent : 0);
    const double length = i > 0 ? from - nodes[i - 1] : 0;
    const HeatPiece& below = pieces_.back();
    const double heat = below.heat + length * (below.capacity + 0.5 * below.slope * length);
    const bool is_last = i + 1 == nodes.size();
    const double slope =
        is_last ? 0 : (filler.volumetric(nodes[i + 1]) - filler.volumetric(from)) / (nodes[i + 1] - from);
    pieces_.push_back({from, heat, c, slope});
  }
}

const GrainHeat::HeatPiece& GrainHeat::piece(double HeatPiece::*member, double value) const {
  const auto above = std::upper_bound(pieces_.begin() + 1, pieces_.end(), value,
                                      [&](double v, const HeatPiece& p) { return v < p.*member; });
  return *(above - 1);
}

double GrainHeat::heat(double kelvin) const {
  const HeatPiece& p = piece(&HeatPiece::from, kelvin);
  const double x = kelvin - p.from;
  return p.heat + x * (p.capacity + 0.5 * p.slope * x);
}

double GrainHeat::temperature(double heat) const {
  const HeatPiece& p = piece(&HeatPiece::heat, heat);
  const double h = heat - p.heat;
  return p.from + 2 * h / (p.capacity + std::sqrt(p.capacity * p.capacity + 2 * p.slope * h));
}

double GrainHeat::capacity(double kelvin) const {
  const HeatPiece& p = piece(&HeatPiece::from, kelvin);
  return p.capacity + p.slope * (kelvin - p.from);
}

namespace {

void nothing(config::Section&) {}

/// Returns why a column next to `temperature` is invalid, or nothing.
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

/// Plausible ranges of tabulated properties.
std::pair<double, double> usual_of(std::string_view unit) {
  if (unit == "W/(m K)") return {1e-3, 1e7};
  if (unit == "J/(kg K)") return {10, 1e5};
  if (unit == "1/K") return {1e-8, 1e-3};
  if (unit == "Pa s") return {1e-6, 1e3};
  return {1e6, 2e12};  // strength and modulus of metals [Pa]
}

void declare_table(config::Section& s, const char* name, const char* unit, std::vector<double>& values,
                   const std::vector<double>& temperature, const char* doc) {
  s.value(name, values).unit(unit, usual_of(unit).first, usual_of(unit).second).required().doc(doc);
  s.check([&] { return problem_of(temperature, values, true); }, name);
}

/// Declares a fluid by constants and lists.
void declare_custom(config::Section& s, MediumInput& p) {
  as_density(s.value("density", p.density)).positive().required().doc("density, a constant");
  as_specific_heat(s.value("specific-heat", p.specific_heat)).positive().required().doc("a constant");
  as_temperature(s.value("temperature", p.temperature)).required().doc("temperatures of the following lists");
  declare_table(s, "conductivity", "W/(m K)", p.conductivity, p.temperature, "piecewise linear");
  declare_table(s, "viscosity", "Pa s", p.viscosity, p.temperature, "piecewise linear");
}

}  // namespace

void declare(config::Section& section, MediumInput& p) {
  using Type = MediumInput::Type;
  const auto known = [&p](config::Section& s) {
    s.value("real-density", p.real_density)
        .doc(
            "true: the density decreases with temperature in the heat of the pores and in the pressure on the wall. false: it "
            "is the constant of thesis table 5.1");
  };
  const auto gas = [&p](config::Section& s) {
    s.value("pressure", p.pressure)
        .unit("Pa", 1e4, 1e8)
        .positive()
        .doc("pressure where the gas leaves the bed");
    s.value("reference-temperature", p.reference_temperature)
        .unit("K")
        .range(150, 1500)
        .doc(
            "temperature of the density used for the heat in the pores; the pressure loss uses the actual temperature");
    s.value("specific-heat", p.air_specific_heat)
        .unit("J/(kg K)")
        .range(900, 1400)
        .doc(
            "constant; the default is that of air near 430 degC (it is 1007 at 50 degC, 1141 at 730 degC); the run assesses "
            "this approximation");
  };
  section.variant<Type>("type", p.type,
                        {{"solar-salt", Type::solar_salt, known},
                         {"caloria-ht43", Type::caloria_ht43, known},
                         {"air", Type::air, gas},
                         {"custom", Type::custom, [&p](config::Section& s) { declare_custom(s, p); }}},
                        "solar-salt: 60 % NaNO3 and 40 % KNO3; caloria-ht43: the oil of Solar One; air: dry "
                        "air, with bed.advection: implicit; custom: the values given in this section",
                        true);
}

void declare(config::Section& s, FillerParameters& f) {
  s.value("density", f.density)
      .unit("kg/m^3", 50, 25000)
      .positive()
      .doc("density of the grains; the defaults are those of quartzite");
  as_specific_heat(s.value("specific-heat", f.specific_heat))
      .positive()
      .doc("specific heat of the grains: a number or a table of T");
  as_conductivity(s.value("conductivity", f.conductivity))
      .positive()
      .doc("conductivity of the grains: a number or a table of T");
  s.check([&f] { return fv::problem_of_property(f.specific_heat); }, "specific-heat");
  s.check([&f] { return fv::problem_of_property(f.conductivity); }, "conductivity");
  s.value("emissivity", f.emissivity)
      .range(0, 1)
      .doc("emissivity of the grains, which exchange radiation through a gas; 0 leaves radiation out");
  s.value("friction-angle", f.friction_angle)
      .unit("rad")
      .range(0.01, 1.5)
      .doc("internal friction angle of the bulk, phi in (5.17)");
  s.value("expansion", f.expansion)
      .unit("1/K", 1e-8, 1e-3)
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
      .unit("J/kg", 1000, 1e7)
      .not_negative()
      .required()
      .doc("latent heat, absorbed evenly over the range");
}

void declare(config::Section& section, SteelParameters& p) {
  using Type = SteelParameters::Type;
  const auto custom = [&p](config::Section& s) {
    as_density(s.value("density", p.density)).positive().doc("density");
    s.value("poissons-ratio", p.poissons_ratio).range(0, 0.499).doc("Poisson's ratio");
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
                        "a metal of thesis table 5.1; custom: the values given in this section", true);
}

void declare(config::Section& s, InsulatorParameters& p) {
  as_density(s.value("density", p.density)).positive().doc("density");
  as_specific_heat(s.value("specific-heat", p.specific_heat)).positive().doc("specific heat");
  as_temperature(s.value("temperature", p.temperature))
      .doc("temperatures of 'conductivity'; absent for a constant");
  as_conductivity(s.value("conductivity", p.conductivity))
      .doc("piecewise linear; default: a wired mineral-wool mat, 0.040 at 50 degC to 0.163 at 500 degC");
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
