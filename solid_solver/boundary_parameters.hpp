// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/config/section.hpp"

namespace couplet {

/// What happens on one patch. `value` and `pressure` are used by the types that have them.
struct SolidBoundary {
  enum class Type { fixed_displacement, traction, pressure, symmetry, free, interface_ };
  Type type = Type::free;
  std::vector<config::ExpressionText> value;  // displacement [m] or traction [Pa], one a component
  config::ExpressionText pressure;            // [Pa], pushes into the solid
};

/// `dimension`: of the scene; read before the boundaries, so it is a reference.
void declare(config::Section& section, SolidBoundary& boundary, const int& dimension);

}  // namespace couplet
