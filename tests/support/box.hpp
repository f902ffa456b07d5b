// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"

namespace couplet::testing {

/// 2 or 3: where the cells of a box lie.
inline int dimension_of(mesh::BoxCells cells) {
  return cells == mesh::BoxCells::quadrilaterals || cells == mesh::BoxCells::triangles ? 2 : 3;
}

}  // namespace couplet::testing
