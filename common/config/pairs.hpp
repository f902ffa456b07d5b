// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace couplet::config {

/// Pairs of keys each of which is plausible alone; for Section::doubt. Empty: nothing to say.

/// sqrt(modulus/density): 1 m/s (gels) to 20 km/s (diamond).
std::string doubt_of_wave_speed(double modulus, double density);
/// viscosity/density: hardly any fluid has less than 5e-8 m^2/s (mercury: 1e-7, water: 1e-6).
std::string doubt_of_kinematic_viscosity(double viscosity, double density);

}  // namespace couplet::config
