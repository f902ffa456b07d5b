// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "common/config/section.hpp"
#include "thermocline/material/properties.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

inline constexpr double stefan_boltzmann = 5.670374e-8;  // [W/(m^2 K^4)]

/// Dry air (or nitrogen, which differs by a few percent) at one temperature and pressure.
struct Air {
  Air(double temperature, double pressure);
  double density, conductivity, viscosity, prandtl, expansion;  // SI
  double specific_heat = 1006;                                  // [J/(kg K)]
  /// Rayleigh number for a length and a temperature difference.
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

/// Heat loss of a surface by convection and radiation, q = coefficient (T - reference) [W/m^2], linearized
/// about a surface temperature.
struct Film {
  double coefficient = 0, reference = 0;
};

/// Side of a tank of height H and diameter D with a metal cover in the shade: cubic combination of natural and forced convection; half the
/// view is sky and half is ground (at air temperature).
Film side_film(double surface, double diameter, double height, const Ambient& air);
/// Roof: turbulent plate of length D in the wind, hot plate facing up; the whole view is sky.
Film roof_film(double surface, double diameter, const Ambient& air);

/// Emissivities of liquid, roof and wall, in the order of Enclosure::Surface.
inline constexpr std::array<double, 3> ullage_emissivity{0.95, 0.8, 0.8};

/// Gray diffuse radiation between liquid, roof and side wall of the ullage. Coaxial equal discs: F = X -
/// sqrt(X^2 - 1), X = 1 + (H/R)^2/2. Net heat from surface i: Q_i = sum_j exchange(i, j) sigma T_j^4. Rows
/// sum to zero (no exchange at equal temperatures), and so do columns (conservation).
struct Enclosure {
  enum Surface { liquid, roof, wall };
  Enclosure(double radius, double height, const std::array<double, 3>& emissivity = ullage_emissivity);
  std::array<std::array<double, 3>, 3> exchange{};  // [m^2]
  double disc_to_disc = 0;                          // view factor
};

/// Gas and radiation between liquid, roof and wall above the liquid. The gas has one temperature. The roof's
/// inner surface has no mass; its temperature follows from the balance with the roof's first cell.
class Ullage {
 public:
  /// `gauge_pressure` of the gas [Pa].
  Ullage(double gauge_pressure, double diameter, double height,
         const std::array<double, 3>& emissivity = ullage_emissivity);

  struct UllageHeat {
    double from_liquid = 0, from_wall = 0, into_roof = 0;  // [W]
    double roof_surface = 0;                               // [K]
    double wall_coefficient = 0;  // d(from_wall)/d(wall temperature) per area of the wall [W/(m^2 K)]
  };
  /// Performs a step of dt at given surface temperatures [K] and updates the gas. `roof_conductance`:
  /// conductance from the roof surface to its first cell [W/K], 0 without an insulated roof.
  UllageHeat step(double dt, double liquid, double wall, double roof_cell, double roof_conductance,
                  double air_pressure);
  double gas_temperature() const { return gas_; }
  void set_gas(double temperature) { gas_ = temperature, roof_ = temperature; }
  double energy(double reference) const { return capacity_ * (gas_ - reference); }  ///< [J]
  double roof_surface() const { return roof_; }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(gas_, roof_);
  }

 private:
  double gauge_pressure_;  // [Pa]
  Enclosure enclosure_;
  double area_, side_, height_;
  double gas_ = 293.15, roof_ = 293.15;
  double capacity_;  // of the gas at 500 K and normal air pressure, constant [J/K]
};

}  // namespace couplet::thermocline
