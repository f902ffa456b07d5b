// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "thermocline/bed/bed_grid.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// Pump or fan that drives the flow through the bed.
struct PumpParameters {
  double efficiency = 0.7;  ///< of pump or fan with its motor
};

/// Ergun 1952, on the superficial mass flux G = rho u: rho dp/dz [Pa kg/m^4]
///   150 mu G (1 - eps)^2/(eps^3 d^2) + 1.75 G^2 (1 - eps)/(eps^3 d)
double ergun(const BedLayer& layer, double viscosity, double flux);

struct PressureLoss {
  double inlet = 0, outlet = 0;  ///< absolute for a gas; of a liquid above the outlet [Pa]
  double loss() const { return inlet - outlet; }
};
/// Across the bed at fluid temperatures `temperature`, a value a cell [K]. For an ideal gas, whose pressure
/// is that of the fluid where it leaves, p dp/dz = R T (...) is integrated exactly in each cell:
///   p_in^2 = p_out^2 + 2 R T dz (...)
PressureLoss pressure_loss(const BedGrid& grid, const Fluid& fluid, std::span<const double> temperature,
                           double mass_flow, double area);

/// Power that the pump (at the bed's cold end) takes [W]: m dp/(rho eta) for a liquid, isentropic compression
/// m c T ((p_in/p_out)^(R/c) - 1)/eta for a gas.
double pump_power(const PressureLoss& loss, const Fluid& fluid, double cold_end, double mass_flow,
                  double efficiency);

}  // namespace couplet::thermocline
