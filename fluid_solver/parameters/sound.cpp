// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::fluid {
namespace {

constexpr double gas_constant = 8.314462618;  // [J/(mol K)]
constexpr double room = 293.15, atmosphere = 101325;

struct Gas {
  const char* name;
  double molar_mass, heat_capacity_ratio;  // [kg/mol], at 20 degC
};
constexpr std::array gases{Gas{"air", 0.028965, 1.400},      Gas{"nitrogen", 0.028013, 1.400},
                           Gas{"oxygen", 0.031999, 1.395},   Gas{"argon", 0.039948, 1.667},
                           Gas{"helium", 0.0040026, 1.667},  Gas{"hydrogen", 0.002016, 1.405},
                           Gas{"methane", 0.016043, 1.306},  Gas{"carbon-dioxide", 0.044010, 1.289},
                           Gas{"ammonia", 0.017031, 1.31},   Gas{"propane", 0.044097, 1.13},
                           Gas{"isobutane", 0.058122, 1.10}, Gas{"r134a", 0.10203, 1.11},
                           Gas{"sf6", 0.14606, 1.095},       Gas{"steam", 0.018015, 1.33}};

struct Liquid {
  const char* name;
  double speed_of_sound, density;  // [m/s, kg/m^3], at 20 degC
};
constexpr std::array liquids{Liquid{"water", 1482, 998},   Liquid{"sea-water", 1522, 1025},
                             Liquid{"ethanol", 1160, 789}, Liquid{"glycerol", 1920, 1261},
                             Liquid{"oil", 1430, 870},     Liquid{"mercury", 1450, 13546}};
// Tolerances of a liquid's density (salt, sugar, temperature); largest pressure of a nearly ideal gas [Pa].
constexpr double least_share = 0.8, largest_share = 1.25, highest_pressure = 2e7;

/// Marczak (1997), 0 to 95 degC.
double of_water(double t) {
  constexpr std::array c{1402.385, 5.038813, -5.799136e-2, 3.287156e-4, -1.398845e-6, 2.787860e-9};
  double speed = 0;
  for (std::size_t i = c.size(); i-- > 0;) speed = speed * t + c[i];
  return speed;
}

Sound of_substance(const CompressibilityParameters& p) {
  const double t = p.temperature.value_or(room), celsius = t - 273.15;
  const std::string name = fmt::format("{} at {:.3g} degC", p.substance, celsius);
  for (const Gas& gas : gases)
    if (p.substance == gas.name) {
      const double gamma = p.heat_capacity_ratio.value_or(gas.heat_capacity_ratio);
      return {std::sqrt(gamma * gas_constant * t / gas.molar_mass), name};
    }
  if (p.substance == "water" && celsius > 0 && celsius < 95) return {of_water(celsius), name};
  const auto liquid =
      std::ranges::find(liquids, p.substance, [](const Liquid& l) { return std::string(l.name); });
  return {liquid->speed_of_sound, p.substance};
}

/// At 1 atm, c^2 = gamma p/rho requires no name: gamma is that of the gas nearest in density at 20 degC.
Sound of_gas(double density, double pressure, std::optional<double> gamma) {
  const auto apart = [&](const Gas& gas) {
    return std::abs(std::log(density * gas_constant * room / (pressure * gas.molar_mass)));
  };
  const Gas& nearest = *std::ranges::min_element(gases, {}, apart);
  const double ratio = gamma.value_or(apart(nearest) < 0.1 ? nearest.heat_capacity_ratio : 1.3);
  return {std::sqrt(ratio * pressure / density),
          fmt::format("a gas of {:.3g} kg/m^3 at {:.4g} kPa", density, 1e-3 * pressure)};
}

/// Requires exactly one of speed, substance and pressure.
void check_source_of_sound(config::Section& s, const CompressibilityParameters& p) {
  s.check(
      [&p]() -> std::string {
        if (p.substance.empty()) return p.temperature ? "'temperature' requires a 'substance'" : "";
        const std::vector<std::string> known = substances();
        if (std::ranges::count(known, p.substance) == 0)
          return fmt::format("unknown substance '{}'. {}", p.substance,
                             base::did_you_mean(p.substance, known, "substances"));
        return p.speed_of_sound || p.pressure ? "give only one of 'speed-of-sound', 'substance' and "
                                                "'pressure'"
                                              : "";
      },
      "substance");
  s.check(
      [&p] {
        return p.speed_of_sound && p.pressure ? "give only one of 'speed-of-sound', 'substance' and "
                                                "'pressure'"
                                              : "";
      },
      "pressure");
}

}  // namespace

std::vector<std::string> substances() {
  std::vector<std::string> names;
  for (const Gas& gas : gases) names.push_back(gas.name);
  for (const Liquid& liquid : liquids) names.push_back(liquid.name);
  return names;
}

void declare(config::Section& s, CompressibilityParameters& p) {
  s.choice("scheme", p.scheme,
           {{"none", WaveScheme::none},
            {"three-level", WaveScheme::three_level},
            {"trapezoidal", WaveScheme::trapezoidal}})
      .doc(
          "time scheme of the pressure of a weakly compressible fluid (small changes of density, any acoustic Courant "
          "number). three-level: damps what a step does not resolve. trapezoidal: a fifth of its error, damps nothing "
          "(a finding reports when it rings). "
          "none: incompressible, and judged by the other keys");
  s.value("mean-time", p.mean_time)
      .unit("s", 1e-9, 1e6)
      .positive()
      .doc(
          "time over which the mean flow and pressure at `absorbing` boundaries are taken; waves of the angular frequency "
          "w are reflected by 1/(2 w mean-time); default: ten times the travel time of sound across the mesh");
  s.value("speed-of-sound", p.speed_of_sound)
      .unit("m/s", 10, 2e4)
      .positive()
      .doc("speed of sound of the fluid");
  s.value("substance", p.substance)
      .doc("alternative: a gas or liquid with known speed of sound: " + base::join(substances()));
  s.value("temperature", p.temperature)
      .unit("K", 70, 5000)
      .positive()
      .doc("temperature of the substance, absolute (20 degC or 293.15 K); default: 20 degC");
  s.value("pressure", p.pressure)
      .unit("Pa", 1, 1e10)
      .positive()
      .doc(
          "alternative: absolute pressure of a gas; the speed of sound is sqrt(heat-capacity-ratio "
          "pressure/density)");
  s.value("heat-capacity-ratio", p.heat_capacity_ratio)
      .range(1, 2)
      .doc(
          "heat capacity ratio of a gas; default: that of the substance, or of the gas with the nearest density");
  s.value("upstream-volume", p.upstream_volume)
      .unit("m^3", 1e-15, 1e6)
      .not_negative()
      .doc(
          "fluid volume upstream of the inlets that is not meshed (a plenum, a cylinder), into which flows what the "
          "inlets prescribe; the pressure at the inlets compresses it. In 2-D per meter of depth; for a symmetric half "
          "the volume behind that half");
  s.optional_section<UpstreamLineParameters>(
      "upstream-line", p.upstream_line,
      [](config::Section& l, UpstreamLineParameters& line) {
        using End = UpstreamLineParameters::End;
        l.value("length", line.length)
            .required()
            .unit("m", 1e-6, 1e5)
            .positive()
            .doc("length of the tube; steps are no longer than a wave takes to its end and back");
        l.value("area", line.area)
            .required()
            .unit("m^2", 1e-12, 1e4)
            .positive()
            .doc(
                "cross-section of the tube; in 2-D per meter of depth, for a symmetric half that behind this half. Waves are "
                "partly reflected at the inlets if these have another area");
        l.choice("end", line.end,
                 {{"closed", End::closed}, {"open", End::open}, {"absorbing", End::absorbing}})
            .doc(
                "far end of the tube. closed: there flows in what the inlets prescribe. open: a reservoir at 'pressure'; "
                "the inlets then prescribe zero. absorbing: the tube goes on, and the pressure and the mean flow that the "
                "inlets prescribe come through it; of a flow that oscillates, half enters as a wave, because a whole "
                "wave has its own pressure, too");
        l.value("pressure", line.pressure).unit("Pa", 1e-6, 1e9).doc("pressure at the far end");
        l.check(
            [&line] {
              return line.end == End::closed && line.pressure != 0
                         ? "a closed end has no pressure of its own; remove the key, or set 'end'"
                         : "";
            },
            "pressure");
      },
      "tube upstream of the inlets that is not meshed, without friction, in which waves travel at the speed of "
      "sound; instead of 'upstream-volume'");
  s.check(
      [&p] {
        return p.upstream_line && p.upstream_volume > 0
                   ? "give only one of 'upstream-volume' and 'upstream-line'"
                   : "";
      },
      "upstream-line");
  check_source_of_sound(s, p);
}

std::string misfit_of(const CompressibilityParameters& p, double density) {
  for (const Liquid& liquid : liquids)
    if (p.substance == liquid.name &&
        (density < least_share * liquid.density || density > largest_share * liquid.density))
      return fmt::format(
          "{} has {:g} kg/m^3, but 'density' is {:g} kg/m^3; change one of them, or give 'speed-of-sound'",
          p.substance, liquid.density, density);
  for (const Gas& gas : gases) {
    const double pressure = density * gas_constant * p.temperature.value_or(room) / gas.molar_mass;
    if (p.substance == gas.name && pressure > highest_pressure)
      return fmt::format(
          "{} with a 'density' of {:g} kg/m^3 would be at {:.3g} bar; change one of them, or give 'speed-of-sound'",
          p.substance, density, 1e-5 * pressure);
  }
  return "";
}

std::optional<Sound> sound_of(const std::optional<CompressibilityParameters>& given, double density,
                              double viscosity) {
  const CompressibilityParameters p = given.value_or(CompressibilityParameters{});
  if (p.speed_of_sound) return Sound{*p.speed_of_sound, "the fluid"};
  if (!p.substance.empty()) return of_substance(p);
  if (p.pressure) return of_gas(density, *p.pressure, p.heat_capacity_ratio);
  // Gases have 5e-6 to 1e-4 Pa s at any temperature; an equally light and more viscous fluid is a model.
  if (density > 0.02 && density < 50 && viscosity > 5e-6 && viscosity < 1e-4)
    return of_gas(density, atmosphere, p.heat_capacity_ratio);
  if (density > 900 && density < 1100) return Sound{1482, "water"};
  if (density > 500) return Sound{1200, "a liquid"};
  return {};
}

double solved_sound(const std::optional<CompressibilityParameters>& p, double density, double viscosity) {
  if (!p || !p->is_solved()) return 0;
  const auto sound = sound_of(p, density, viscosity);
  if (!sound)
    throw Error(
        "compressibility: a fluid of {:g} kg/m^3 and {:g} Pa s is no known gas or liquid: give its 'speed-of-sound', or "
        "'scheme: none'.",
        density, viscosity);
  return sound->speed;
}

}  // namespace couplet::fluid
