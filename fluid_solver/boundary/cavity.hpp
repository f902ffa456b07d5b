// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/coupling/participant.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// An incompressible fluid without an outlet lets no wall move that would change its volume, unless something sets
/// its pressure level (`volume-level`). Throws Error for a fluid whose volume is trapped, or that asks for a level it
/// does not need. Collective.
template <int D>
void check_cavity(const Fluid<D>& fluid, coupling::Scheme scheme);

/// What the given velocities let into the fluid at t^{n+1} and t^n [m^3/s], for each of the interface's faces (face
/// by face, two values) its share by area: the sums are the inflows. Collective.
template <int D>
std::vector<double> inflow_shares(const Fluid<D>& fluid, const std::vector<Index>& faces, double time,
                                  double dt);

}  // namespace couplet::fluid
