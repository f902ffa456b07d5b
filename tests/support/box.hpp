// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"

namespace couplet::testing {

/// 2 or 3: where the cells of a box lie.
inline int dimension_of(BoxCells cells) {
  return cells == BoxCells::quadrilaterals || cells == BoxCells::triangles ? 2 : 3;
}

}  // namespace couplet::testing
