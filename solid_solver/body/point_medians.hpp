// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// One of several numbers that belong to a point.
struct PointShare {
  GlobalIndex point;  ///< Mesh::point_id
  double share;
};

/// Of each `wanted` local point the median of the shares that all ranks found for it; NaN of other points and where there are none.
/// Few points. Collective.
std::vector<double> medians(const mesh::Mesh& mesh, const std::vector<PointShare>& shares,
                            std::span<const std::uint8_t> wanted);

}  // namespace couplet::solid
