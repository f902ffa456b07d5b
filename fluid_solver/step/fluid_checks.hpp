// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/boundary/boundary.hpp"

namespace couplet::fluid {

/// Resolves `surface: auto` of bodies. Throws Error if two bodies differ.
FluidParameters with_surfaces(FluidParameters parameters, bool moving);

/// Throws Error for effects that do not go together; where one leaves a single choice of another, sets it. `moving`: the
/// mesh will move. Collective.
template <int D>
void check_together(const mesh::Mesh& mesh, const Boundary<D>& boundary, FluidParameters& parameters,
                    bool moving);

}  // namespace couplet::fluid
