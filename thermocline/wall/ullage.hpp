// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "common/config/section.hpp"
#include "thermocline/wall/environment.hpp"

namespace couplet::thermocline {

struct UllageParameters {
  double gauge_pressure = 0;  ///< [Pa]
  double emissivity_liquid = 0.95, emissivity_roof = 0.8, emissivity_wall = 0.8;
};

/// Radiation between liquid, roof and side wall of the ullage, grey and diffuse; coaxial equal discs: F = X -
/// sqrt(X^2 - 1), X = 1 + (H/R)^2/2. Net heat that leaves surface i: Q_i = sum_j exchange(i, j) sigma T_j^4;
/// the rows sum to zero (no exchange at equal temperatures), and the columns (what one loses others gain).
struct Enclosure {
  enum Surface { liquid, roof, wall };
  Enclosure(const UllageParameters& parameters, double radius, double height);
  std::array<std::array<double, 3>, 3> exchange{};  // [m^2]
  double disc_to_disc = 0;                          // view factor
};

/// Gas and radiation between the liquid, the roof and the wall above the liquid. The gas has one temperature;
/// the roof's inner surface has no mass and follows from its balance against the roof's first cell.
class Ullage {
 public:
  Ullage(const UllageParameters& parameters, double diameter, double height);

  struct Heat {
    double from_liquid = 0, from_wall = 0, into_roof = 0;  // [W]
    double roof_surface = 0;                               // [K]
    double wall_coefficient = 0;  // d(from_wall)/d(wall temperature) per area of the wall [W/(m^2 K)]
  };
  /// Over dt between surfaces of given temperature [K]. `roof_conductance`: roof surface to the roof's first
  /// cell [W/K], 0 without an insulated roof. Changes the gas.
  Heat step(double dt, double liquid, double wall, double roof_cell, double roof_conductance,
            double air_pressure);
  double gas_temperature() const { return gas_; }
  void set_gas(double temperature) { gas_ = temperature, roof_ = temperature; }
  double energy(double reference) const { return capacity_ * (gas_ - reference); }  ///< [J]
  double roof_surface() const { return roof_; }
  std::array<double, 2> state() const { return {gas_, roof_}; }
  void restore(double gas, double roof) { gas_ = gas, roof_ = roof; }

 private:
  UllageParameters parameters_;
  Enclosure enclosure_;
  double area_, side_, height_;
  double gas_ = 293.15, roof_ = 293.15;
  double capacity_;  // of the gas at 500 K and the air's normal pressure, a constant [J/K]
};

void declare(config::Section& section, UllageParameters& parameters);

}  // namespace couplet::thermocline
