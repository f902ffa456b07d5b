// SPDX-License-Identifier: Apache-2.0
#include "common/config/pairs.hpp"

#include <fmt/format.h>

#include <cmath>

namespace couplet::config {

std::string doubt_of_wave_speed(double modulus, double density) {
  constexpr double slowest = 0.999, fastest = 20e3;  // [m/s]
  if (!(modulus > 0) || !(density > 0)) return "";
  const double speed = std::sqrt(modulus / density);
  if (speed >= slowest && speed <= fastest) return "";
  return fmt::format(
      "waves would travel at {:.3g} m/s (usual: 1 to 20000 m/s): implausible; check the units of the modulus ({:g} Pa) and of the "
      "density ({:g} kg/m^3).",
      speed, modulus, density);
}

std::string doubt_of_kinematic_viscosity(double viscosity, double density) {
  constexpr double least = 5e-8;  // [m^2/s]
  if (!(viscosity > 0) || !(density > 0) || viscosity / density >= least) return "";
  return fmt::format(
      "viscosity/density is {:.3g} m^2/s (usual: at least {:g} m^2/s): implausible; 'viscosity' is the dynamic one, in Pa s: the "
      "kinematic one times the density would be {:g} Pa s.",
      viscosity / density, least, viscosity * density);
}

}  // namespace couplet::config
