// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "common/fv/expression.hpp"
#include "solid_solver/parameters/parameter_checks.hpp"

namespace couplet::solid {
namespace {

bool takes_temperature(const SolidParameters& p) { return p.interface_data && p.interface_data->temperature; }

/// What the temperature needs and what excludes another source of it.
void check_heat(config::Section& s, SolidParameters& p) {
  s.check(
      [&] {
        return p.thermoelastic_coupling &&
                       !(p.expansion && p.heat && p.heat->analysis == HeatParameters::Analysis::transient)
                   ? "it requires a transient 'heat' and 'thermal-expansion'"
                   : "";
      },
      "thermoelastic-coupling");
  const auto needs = [&](std::optional<config::ExpressionText> HeatMaterial::*property, bool needed,
                         const char* key, const char* by) {
    s.check(
        [&p, property, needed, key, by]() -> std::string {
          for (const SolidMaterial& m : materials_of(p))
            if (needed && !(m.heat.*property))
              return fmt::format("'{}' of the material is missing; {} needs it", key, by);
          return "";
        },
        p.materials.empty() ? "material" : "materials");
  };
  s.check([&] { return p.temperature ? fv::problem_of(*p.temperature) : ""; }, "temperature");
  s.check(
      [&] {
        return takes_temperature(p) && (p.heat || p.temperature)
                   ? "the temperature is received at the interface; remove 'heat' or 'temperature'"
                   : "";
      },
      "interface");
  s.check(
      [&] { return p.heat && p.temperature ? "'heat' computes the temperature; remove one of the two" : ""; },
      "temperature");
  s.check(
      [&] {
        return p.expansion && !p.heat && !p.temperature && !takes_temperature(p)
                   ? "thermal strain needs a temperature; add 'heat' or 'temperature'"
                   : "";
      },
      "thermal-expansion");
  s.check(
      [&] {
        return p.analysis == SolidParameters::Analysis::thermal && !p.heat ? "a thermal analysis needs 'heat'"
                                                                           : "";
      },
      "analysis");
  needs(&HeatMaterial::conductivity, p.heat.has_value(), "conductivity", "'heat'");
  needs(&HeatMaterial::specific_heat, p.heat && p.heat->analysis == HeatParameters::Analysis::transient,
        "specific-heat", "a transient 'heat'");
  needs(&HeatMaterial::expansion, p.expansion.has_value(), "expansion", "'thermal-expansion'");
}

}  // namespace

void declare_heat(config::Section& s, SolidParameters& p) {
  s.optional_section<HeatParameters>(
      "heat", p.heat, [](config::Section& h, HeatParameters& v) { declare(h, v); },
      "heat conduction; each step solves for the temperature before the displacement");
  s.value("temperature", p.temperature)
      .unit("K")
      .plausible(70, 5000)
      .doc("prescribed temperature, of x, y, z, t");
  s.optional_section<ThermalExpansion>(
      "thermal-expansion", p.expansion, [](config::Section& e, ThermalExpansion& v) { declare(e, v); },
      "thermal strain; requires 'heat' or 'temperature', and 'expansion' of the material");
  s.optional_section<InterfaceData>(
      "interface", p.interface_data, [](config::Section& i, InterfaceData& v) { declare(i, v); },
      "data that patches of type 'interface' receive from the coupler; absent: forces");
  s.value("stiffness-tolerance", p.stiffness_tolerance)
      .range(0, 0.1)
      .doc(
          "relative change of youngs-modulus-table and poissons-ratio-table at which the matrix is "
          "reassembled");
  s.value("thermoelastic-coupling", p.thermoelastic_coupling)
      .doc("cooling by stretching: heat of the strain rate, thesis (2.27), lagged by one step");
  check_heat(s, p);
}

}  // namespace couplet::solid
