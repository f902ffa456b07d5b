// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/environment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace couplet::thermocline {
namespace {

Film combine(double convection, double emissivity, double surface, double surroundings4, double gain,
             const Ambient& air) {
  // eps sigma (T^4 - T_env^4) linear about the surface temperature.
  const double radiation = 4 * emissivity * stefan_boltzmann * std::pow(surface, 3);
  const double offset = emissivity * stefan_boltzmann * (3 * std::pow(surface, 4) + surroundings4);
  Film film;
  film.coefficient = convection + radiation;
  film.reference = (convection * air.temperature + offset + gain) / film.coefficient;
  return film;
}

double cubes(double a, double b) { return std::cbrt(a * a * a + b * b * b); }

}  // namespace

Air::Air(double t, double pressure) {
  density = pressure / (287.05 * t);
  // Sutherland's laws of viscosity and conductivity.
  viscosity = 1.716e-5 * std::pow(t / 273.15, 1.5) * (273.15 + 110.4) / (t + 110.4);
  conductivity = 0.0241 * std::pow(t / 273.15, 1.5) * (273.15 + 194) / (t + 194);
  prandtl = viscosity * specific_heat / conductivity;
  expansion = 1 / t;
}

double Air::rayleigh(double difference, double length) const {
  const double nu = viscosity / density;
  return 9.81 * expansion * std::abs(difference) * std::pow(length, 3) / (nu * nu) * prandtl;
}

double vertical_plate_nusselt(double ra, double pr) {
  const double part = std::pow(1 + std::pow(0.492 / pr, 9.0 / 16), 8.0 / 27);
  const double root = 0.825 + 0.387 * std::pow(ra, 1.0 / 6) / part;
  return root * root;
}

double cross_flow_nusselt(double re, double pr) {
  return 0.3 + 0.62 * std::sqrt(re) * std::cbrt(pr) / std::pow(1 + std::pow(0.4 / pr, 2.0 / 3), 0.25) *
                   std::pow(1 + std::pow(re / 282000, 0.625), 0.8);
}

double hot_plate_up_nusselt(double ra) { return ra < 1e7 ? 0.54 * std::pow(ra, 0.25) : 0.15 * std::cbrt(ra); }

double sky_temperature(double air) { return 0.0552 * std::pow(air, 1.5); }

Film side_film(const OutsideParameters& p, double surface, double diameter, double height,
               const Ambient& air) {
  const Air film(0.5 * (surface + air.temperature), air.pressure);
  const double re = film.density * air.wind * diameter / film.viscosity;
  const double forced = cross_flow_nusselt(re, film.prandtl) * film.conductivity / diameter;
  const double still =
      vertical_plate_nusselt(film.rayleigh(surface - air.temperature, height), film.prandtl) *
      film.conductivity / height;
  const double around =
      0.5 * std::pow(sky_temperature(air.temperature), 4) + 0.5 * std::pow(air.temperature, 4);
  // The sun meets the projection D H of the side's area pi D H.
  const double across = std::sqrt(std::max(0.0, 1 - air.sun_height * air.sun_height));
  const double gain = air.sun_height > 0 ? p.solar_absorptance * air.dni * across / std::numbers::pi : 0;
  return combine(cubes(forced, still), p.emissivity, surface, around, gain, air);
}

Film roof_film(const OutsideParameters& p, double surface, double diameter, const Ambient& air) {
  const Air film(0.5 * (surface + air.temperature), air.pressure);
  const double re = film.density * air.wind * diameter / film.viscosity;
  const double forced = 0.037 * std::pow(re, 0.8) * std::cbrt(film.prandtl) * film.conductivity / diameter;
  const double length = diameter / 4;
  const double still =
      hot_plate_up_nusselt(film.rayleigh(surface - air.temperature, length)) * film.conductivity / length;
  const double sky = std::pow(sky_temperature(air.temperature), 4);
  const double gain = p.solar_absorptance * air.dni * std::max(0.0, air.sun_height);
  return combine(cubes(forced, still), p.emissivity, surface, sky, gain, air);
}

}  // namespace couplet::thermocline
