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

/// What an ideal flow would need to carry the same mass with the same difference of pressure, (KA)_e in [thesis] eq. (4.35).
struct FlowArea {
  double mass_flow = 0;      ///< into the fluid through the first patch [kg/s]
  double pressure_drop = 0;  ///< mean pressures of the first less the second patch [Pa]
  double area =
      0;  ///< [m^2]; negative where the flow goes against the pressure; NaN where there is no difference
};
template <int D>
FlowArea flow_area(const PatchFlux<D>& from, const PatchFlux<D>& to, double density);

/// Of all patches with faces: volume, carried momentum and pressure at the accepted time, loads (those of forces.csv) as
/// means over the last step; in a steady flow without body forces the sums of volume and momentum are zero. Nothing
/// before the first step. Collective.
template <int D>
std::vector<PatchFlux<D>> patch_fluxes(const Fluid<D>& fluid);

}  // namespace couplet::fluid
