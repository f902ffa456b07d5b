// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// What passes through a patch out of the fluid, relative to the patch where it moves.
template <int D>
struct PatchFlux {
  std::string patch;
  double volume = 0;                   ///< [m^3/s]
  Vec<D> momentum = Vec<D>::Zero();    ///< rho sum u phi plus the load on what is outside [N]
  double mean_pressure = 0, area = 0;  ///< [Pa], over the area; [m^2]
};

/// Of all patches with faces: volume, carried momentum and pressure at the accepted time, loads (those of forces.csv) as
/// means over the last step; in a steady flow without body forces the sums of volume and momentum are zero. Nothing
/// before the first step. Collective.
template <int D>
std::vector<PatchFlux<D>> patch_fluxes(const Fluid<D>& fluid);

}  // namespace couplet::fluid
