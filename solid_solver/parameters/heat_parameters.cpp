// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/heat_parameters.hpp"

#include "common/fv/expression.hpp"
#include "common/fv/table.hpp"
#include "solid_solver/parameters/parameter_checks.hpp"

namespace couplet::solid {

namespace {

using Text = std::optional<config::ExpressionText>;

struct HeatProperty {
  const char *name, *unit;
  double lowest, highest;  // usual magnitudes
};

void declare_property(config::Section& s, const HeatProperty& q, Text& text, bool is_positive,
                      const char* doc) {
  {
    config::Key key = s.value(q.name, text);
    key.unit(q.unit, q.lowest, q.highest).doc(doc);
    if (is_positive) key.positive();
  }
  s.check([&text] { return text ? fv::problem_of_property(*text) : std::string(); }, q.name);
}

void declare_boundary(config::Section& s, HeatBoundary& b) {
  using Type = HeatBoundary::Type;
  const auto expression = [](config::Section& v, const HeatProperty& q, config::ExpressionText& text,
                             const char* doc, double least = -std::numeric_limits<double>::infinity()) {
    v.value(q.name, text)
        .range(least, std::numeric_limits<double>::infinity())
        .unit(q.unit, q.lowest, q.highest)
        .required()
        .doc(doc);
  };
  s.variant<Type>(
      "type", b.type,
      {{"temperature", Type::temperature,
        [&b, expression](config::Section& v) {
          expression(v, {"value", "K", 70, 5000}, b.value, "temperature, an expression of x, y, z, t");
        }},
       {"flux", Type::flux,
        [&b, expression](config::Section& v) {
          expression(v, {"value", "W/m^2", 1e-6, 1e11}, b.value,
                     "heat flux into the solid, an expression of x, y, z, t");
        }},
       {"convection", Type::convection,
        [&b, expression](config::Section& v) {
          expression(v, {"coefficient", "W/(m^2 K)", 1e-3, 1e7}, b.coefficient,
                     "heat transfer coefficient, an expression of x, y, z, t", 0);
          expression(v, {"ambient", "K", 70, 5000}, b.ambient,
                     "temperature of the fluid, an expression of x, y, z, t");
        }},
       {"adiabatic", Type::adiabatic, [](config::Section&) {}},
       {"symmetry", Type::symmetry, [](config::Section&) {}},
       {"interface", Type::interface, [](config::Section&) {}}},
      "thermal condition of the patch; a symmetry plane must be flat. interface: heat passes to the participant of the coupling "
      "that meets the solid here (conjugate heat transfer)",
      true);
}

}  // namespace

void declare(config::Section& s, HeatMaterial& m) {
  declare_property(s, {"conductivity", "W/(m K)", 1e-3, 1e4}, m.conductivity, true,
                   "thermal conductivity: a number or a table of T");
  declare_property(s, {"specific-heat", "J/(kg K)", 10, 1e5}, m.specific_heat, true,
                   "specific heat: a number or a table of T");
  declare_property(s, {"expansion", "1/K", 1e-8, 1e-2}, m.expansion, false,
                   "instantaneous coefficient of thermal expansion: a number or a table of T, integrated "
                   "from the reference temperature");
  declare_property(s, {"youngs-modulus-table", "Pa", 1, 2e12}, m.youngs_modulus, true,
                   "table of T that replaces youngs-modulus where the temperature is known");
  s.value("poissons-ratio-table", m.poissons_ratio)
      .range(-0.99, 0.49999)
      .doc("table of T that replaces poissons-ratio where the temperature is known");
  s.check([&m] { return m.poissons_ratio ? fv::problem_of_property(*m.poissons_ratio) : std::string(); },
          "poissons-ratio-table");
}

void declare(config::Section& s, HeatParameters& h) {
  using Analysis = HeatParameters::Analysis;
  using Scheme = HeatParameters::Scheme;
  s.choice("analysis", h.analysis, {{"transient", Analysis::transient}, {"steady", Analysis::steady}})
      .doc("steady neglects the heat stored in the solid");
  s.choice(
       "time-scheme", h.scheme,
       {{"euler", Scheme::euler}, {"three-point", Scheme::three_point}, {"trapezoidal", Scheme::trapezoidal}})
      .doc(
          "euler is first order; three-point (backward differences with variable steps) and trapezoidal are second order");
  s.value("initial-temperature", h.initial_temperature)
      .unit("K", 70, 5000)
      .doc("initial temperature, an expression of x, y, z");
  s.value("source", h.source)
      .unit("W/m^3", 1e-6, 1e14)
      .doc("heat source in the solid, an expression of x, y, z, t");
  s.map<HeatBoundary>(
      "boundaries", h.boundaries, [](config::Section& b, HeatBoundary& v) { declare_boundary(b, v); },
      "patch", "patches that are not adiabatic; mechanical symmetry planes are also thermal symmetry planes");
  s.check(
      [&h] {
        const bool meets = std::ranges::any_of(
            h.boundaries, [](const auto& b) { return b.second.type == HeatBoundary::Type::interface; });
        return meets && h.scheme == HeatParameters::Scheme::trapezoidal
                   ? "heat that another participant gives needs 'three-point' or 'euler'"
                   : "";
      },
      "time-scheme");
  s.value("tolerance", h.tolerance)
      .range(1e-14, 1e-2)
      .doc(
          "convergence limit of the iteration over temperature-dependent properties: change of the temperature relative to its "
          "range");
  s.value("max-iterations", h.max_iterations)
      .range(1, 1000)
      .doc("maximum number of these iterations; beyond it the step fails");
}

void declare(config::Section& s, ThermalExpansion& e) {
  s.value("reference-temperature", e.reference_temperature)
      .unit("K", 70, 5000)
      .doc("temperature of zero thermal strain");
}

void declare_heat(config::Section& s, SolidParameters& p) {
  s.optional_section<HeatParameters>(
      "heat", p.heat, [](config::Section& h, HeatParameters& v) { declare(h, v); },
      "heat conduction; each step solves for the temperature before the displacement");
  s.value("temperature", p.temperature)
      .unit("K", 70, 5000)
      .doc("prescribed temperature, an expression of x, y, z, t");
  s.optional_section<ThermalExpansion>(
      "thermal-expansion", p.expansion, [](config::Section& e, ThermalExpansion& v) { declare(e, v); },
      "thermal strain; requires 'heat' or 'temperature', and 'expansion' of the material");
  s.optional_section<InterfaceData>(
      "interface", p.interface_data, [](config::Section& i, InterfaceData& v) { declare(i, v); },
      "data that patches of type 'interface' receive from the coupler; default: forces");
  s.value("thermoelastic-coupling", p.thermoelastic_coupling)
      .doc("thermoelastic cooling by stretching: heat of the strain rate, thesis (2.27), lagged by one step");
}

}  // namespace couplet::solid
