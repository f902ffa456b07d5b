// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/base/types.hpp"

namespace couplet::elastic {

/// Entry i of a field with `dim` values each; z is 0 in 2-D.
inline Vec3 vector_at(std::span<const double> values, Index i, int dim) {
  Vec3 u = Vec3::Zero();
  for (int a = 0; a < dim; ++a) u[a] = values[std::size_t(i) * dim + a];
  return u;
}

}  // namespace couplet::elastic
