// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "solid_solver/boundary/distributed_force.hpp"
#include "solid_solver/parameters/load_parameters.hpp"

namespace couplet::solid {

/// The faces of this rank that take a point load: those that are open and have their centre within its radius; without a
/// radius the nearest face of all ranks, which must be open. `open`: per boundary face of owned cells, whether a force on it has
/// an effect. Throws Error, naming `where`. Collective.
std::vector<Index> faces_of_point_load(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                       const PointLoad& load, std::span<const std::uint8_t> open,
                                       const std::string& where);

}  // namespace couplet::solid
