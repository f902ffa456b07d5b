// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/pressure_loss.hpp"

#include <cmath>

namespace couplet::thermocline {

double ergun(const BedLayer& layer, double viscosity, double flux) {
  const double eps = layer.porosity, solid = 1 - eps, d = layer.diameter, eps3 = eps * eps * eps;
  return 150 * viscosity * flux * solid * solid / (eps3 * d * d) + 1.75 * flux * flux * solid / (eps3 * d);
}

PressureLoss pressure_loss(const BedGrid& grid, const Fluid& fluid, std::span<const double> temperature,
                           double mass_flow, double area) {
  const double flux = std::abs(mass_flow) / area;
  double sum = 0;  // of dz (...) over the density, times p for a gas
  for (int i = 0; i < grid.size(); ++i) {
    const double t = temperature[i];
    const double drag = grid.dz[i] * ergun(grid.runs[grid.layer[i]].layer, fluid.viscosity(t), flux);
    sum += fluid.is_gas() ? fluid.gas_constant * t * drag : drag / fluid.density_at(t);
  }
  if (!fluid.is_gas()) return {sum, 0};
  return {std::sqrt(fluid.pressure * fluid.pressure + 2 * sum), fluid.pressure};
}

double pump_power(const PressureLoss& loss, const Fluid& fluid, double cold_end, double mass_flow,
                  double efficiency) {
  const double m = std::abs(mass_flow), c = fluid.specific_heat;
  if (!fluid.is_gas()) return m * loss.loss() / (fluid.density_at(cold_end) * efficiency);
  const double exponent = fluid.gas_constant / c;
  return m * c * cold_end * std::expm1(exponent * std::log(loss.inlet / loss.outlet)) / efficiency;
}

}  // namespace couplet::thermocline
