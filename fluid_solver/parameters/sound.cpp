// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::fluid {
namespace {

constexpr double gas_constant = 8.314462618;  // [J/(mol K)]
constexpr double room = 293.15, atmosphere = 101325;

struct Gas {
  double molar_mass, heat_capacity_ratio;  // [kg/mol], at 20 degC
};
/// Air, nitrogen, oxygen, argon, helium, hydrogen, methane, carbon dioxide, ammonia, propane, isobutane, R134a, sulfur
/// hexafluoride, steam.
constexpr std::array gases{Gas{0.028965, 1.400}, Gas{0.028013, 1.400},  Gas{0.031999, 1.395},
                           Gas{0.039948, 1.667}, Gas{0.0040026, 1.667}, Gas{0.002016, 1.405},
                           Gas{0.016043, 1.306}, Gas{0.044010, 1.289},  Gas{0.017031, 1.31},
                           Gas{0.044097, 1.13},  Gas{0.058122, 1.10},   Gas{0.10203, 1.11},
                           Gas{0.14606, 1.095},  Gas{0.018015, 1.33}};

/// At 1 atm, c^2 = gamma p/rho requires no name: gamma is that of the gas nearest in density at 20 degC.
Sound of_gas(double density) {
  const auto apart = [&](const Gas& gas) {
    return std::abs(std::log(density * gas_constant * room / (atmosphere * gas.molar_mass)));
  };
  const Gas& nearest = *std::ranges::min_element(gases, {}, apart);
  const double ratio = apart(nearest) < 0.1 ? nearest.heat_capacity_ratio : 1.3;
  return {std::sqrt(ratio * atmosphere / density),
          fmt::format("a gas of {:.3g} kg/m^3 at {:.4g} kPa", density, 1e-3 * atmosphere)};
}

}  // namespace

void declare(config::Section& s, CompressibilityParameters& p) {
  s.choice("scheme", p.scheme,
           {{"none", WaveScheme::none},
            {"three-level", WaveScheme::three_level},
            {"trapezoidal", WaveScheme::trapezoidal}})
      .doc(
          "time scheme of the pressure of a weakly compressible fluid (small changes of density, any acoustic Courant number). "
          "three-level: damps waves that a step does not resolve. trapezoidal: has a fifth of the error of three-level, but no "
          "damping (a finding reports if the pressure rings). none: incompressible, which the run assesses with the other "
          "keys");
  s.value("mean-time", p.mean_time)
      .unit("s", 1e-9, 1e6)
      .positive()
      .doc(
          "averaging time of the flow and pressure at `absorbing` boundaries; waves of angular frequency w are reflected with "
          "the coefficient 1/(2 w mean-time); default: ten times the travel time of sound across the mesh");
  s.value("speed-of-sound", p.speed_of_sound)
      .unit("m/s", 10, 2e4)
      .positive()
      .doc(
          "speed of sound of the fluid: air 343, water 1482, oil 1430 m/s at 20 degC, an ideal gas sqrt(gamma p / density); "
          "default: found from density and viscosity, if they are those of a gas at 1 atm or of a liquid");
  s.value("upstream-volume", p.upstream_volume)
      .unit("m^3", 1e-15, 1e6)
      .not_negative()
      .doc(
          "unmeshed fluid volume upstream of the inlets (a plenum, a cylinder), into which the flow prescribed at the inlets "
          "enters and which the pressure at the inlets compresses. In 2-D it is a volume per meter of depth; for a symmetric "
          "half, it is the volume behind that half");
}

std::optional<Sound> sound_of(const std::optional<CompressibilityParameters>& given, double density,
                              double viscosity) {
  if (given && given->speed_of_sound) return Sound{*given->speed_of_sound, "the fluid"};
  // Gases have 5e-6 to 1e-4 Pa s at any temperature; an equally light and more viscous fluid is a model.
  if (density > 0.02 && density < 50 && viscosity > 5e-6 && viscosity < 1e-4) return of_gas(density);
  if (density > 900 && density < 1100) return Sound{1482, "water"};
  if (density > 500) return Sound{1200, "a liquid"};
  return {};
}

double solved_sound(const std::optional<CompressibilityParameters>& p, double density, double viscosity) {
  if (!p || !p->is_solved()) return 0;
  const auto sound = sound_of(p, density, viscosity);
  if (!sound)
    throw Error(
        "compressibility: a fluid of {:g} kg/m^3 and {:g} Pa s is not a known gas or liquid: give its 'speed-of-sound', or "
        "'scheme: none'.",
        density, viscosity);
  return sound->speed;
}

}  // namespace couplet::fluid
