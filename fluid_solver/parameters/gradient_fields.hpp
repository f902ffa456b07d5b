// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/base/types.hpp"

namespace couplet::fluid {

/// A field made from the velocity gradient g, g(i, j) = du_i/dx_j [1/s], of each cell. In 2-D, z has no part in g.
struct GradientField {
  const char *name, *unit;  ///< the name is a key of `output` that enables the field
  const char* meaning;
  bool is_vector;  ///< three components; in 2-D only the last one. Otherwise only the first.
  Vec3 (*value)(const Tensor3& g);
};
/// All such fields.
std::span<const GradientField> gradient_fields();

}  // namespace couplet::fluid
