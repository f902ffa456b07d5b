// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "thermocline/base/interfaces.hpp"

/// Air and sky around the tank.
namespace couplet::thermocline {

inline constexpr double stefan_boltzmann = 5.670374e-8;  // [W/(m^2 K^4)]

/// Dry air (or nitrogen, which differs by a few per cent) at one temperature and pressure.
struct Air {
  Air(double temperature, double pressure);
  double density, conductivity, viscosity, prandtl, expansion;  // SI
  double specific_heat = 1006;                                  // [J/(kg K)]
  /// Rayleigh number on a length at a temperature difference.
  double rayleigh(double difference, double length) const;
};

/// Vertical plate, Churchill and Chu 1975, for all Ra.
double vertical_plate_nusselt(double rayleigh, double prandtl);
/// Cylinder in cross flow, Churchill and Bernstein 1977.
double cross_flow_nusselt(double reynolds, double prandtl);
/// Hot plate facing up: 0.54 Ra^(1/4), above Ra = 1e7 0.15 Ra^(1/3), on length D/4.
double hot_plate_up_nusselt(double rayleigh);
/// Swinbank 1963: 0.0552 T^1.5 [K].
double sky_temperature(double air);

/// What a surface loses: q = coefficient (T - reference) [W/m^2], convection and radiation together, linear
/// about the surface temperature it was made for.
struct Film {
  double coefficient = 0, reference = 0;
};

struct OutsideParameters {
  double emissivity = 0.2;       ///< of the cover
  double solar_absorptance = 0;  ///< of the cover; 0: the sun is left out
};

/// Side of a tank of height H, diameter D: natural and forced convection combined by their cubes, half of the
/// view the sky's and half the ground's (at air temperature).
Film side_film(const OutsideParameters& p, double surface, double diameter, double height,
               const Ambient& air);
/// Roof: turbulent plate of length D in the wind, hot plate facing up, the whole view the sky's.
Film roof_film(const OutsideParameters& p, double surface, double diameter, const Ambient& air);

}  // namespace couplet::thermocline
