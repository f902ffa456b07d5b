// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/mesh/mesh.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// The second wall of each gap with a `height` stands there: the seat that a structure lands on is that of the mesh.
/// Throws Error if a point is off by more than a tenth of the opening. Collective.
void check_seats(const mesh::Mesh& mesh, const FluidParameters& parameters, std::span<const Vec3> points);

}  // namespace couplet::fluid
