// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/mesh/periodic_points.hpp"
#include "fluid_solver/boundary/boundary.hpp"

namespace couplet::fluid {

/// Throws Error for effects that do not go together; where one leaves a single choice of another, sets it. `moving`: the
/// mesh will move. Collective.
template <int D>
void check_together(const Mesh& mesh, const Boundary<D>& boundary, FluidParameters& parameters, bool moving);

/// Throws Error where the points at `time` part what is joined: its faces would have two shapes. Collective.
void refuse_torn(const Mesh& mesh, const PeriodicPoints& periodic, std::span<const Vec3> points, double time);

}  // namespace couplet::fluid
