// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Numbers of a part's points by local point of the body (-1: not of the part), owned ones first: also those that only other ranks
/// use. `uses`: 1 for those that are used here. `points` becomes the local points of the body. Collective.
std::vector<Index> number_points(const mesh::Mesh& body, std::vector<double> uses,
                                 std::vector<Index>& points);

/// Their map, ids and places [m]. Collective.
void set_points(mesh::Mesh& part, std::vector<Vec3>& there, const mesh::Mesh& body,
                std::span<const Vec3> places, std::span<const Index> points, std::span<const Index> number);

}  // namespace couplet::io
