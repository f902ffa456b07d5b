// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Eddy viscosity of the unresolved scales [m^2/s] from the velocity gradient g_ij = du_i/dx_j of one cell
/// and its width D = V^(1/dimension):
///   Smagorinsky  (C D)^2 (2 S:S)^(1/2)                                              [smagorinsky1963]
///   WALE         (C D)^2 (Sd:Sd)^(3/2) / ((S:S)^(5/2) + (Sd:Sd)^(5/4))              [nicoud1999]
/// S the symmetric part of g, Sd the traceless symmetric part of g g. WALE vanishes in pure shear and as y^3
/// at walls.
template <int D>
double eddy_viscosity(const TurbulenceParameters& model, const Tensor<D>& gradient, double volume);

/// Eddy viscosity of all local cells. `gradient` has its ghosts.
template <int D>
void eddy_viscosity(const TurbulenceParameters& model, const Placement<D>& at,
                    const std::vector<Tensor<D>>& gradient, std::vector<double>& eddy);

}  // namespace couplet::fluid
