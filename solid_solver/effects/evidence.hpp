// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

namespace couplet::solid {

/// Evidence of a run of the solid for whether an effect was rightly left out. NaN: not seen.
struct SolidEvidence {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double largest_gradient = unknown;     ///< Frobenius norm of the displacement gradient, over space and time
  double largest_strain = unknown;       ///< of the same; at the last look only
  double largest_rotation = unknown;     ///< angle of a face's surroundings [rad]; at the last look only
  double share_of_yield = unknown;       ///< largest equivalent stress over the yield strength
  double inertia_over_load = unknown;    ///< of a static run with several steps
  double coupling_number = unknown;      ///< stiffening by the heat of deformation, thesis (2.27)
  double temperature_range = unknown;    ///< of a run that knows a temperature [K]
  double temperature_change = unknown;   ///< of the same: largest distance from the reference temperature [K]
  std::string large_strain{};            ///< what it would change, where that was asked for
  double large_strain_change = unknown;  ///< the same over the displacement [1]; NaN: there is no equilibrium
  bool large_strain_estimated = false;   ///< it was asked for
  double buckling_factor = unknown;      ///< load that buckles over the load; known where it is low
  double kinetic_over_strain = unknown;  ///< of a dynamic run: largest kinetic over largest strain energy
  double dynamic_steps = unknown;        ///< of a dynamic run
};

}  // namespace couplet::solid
