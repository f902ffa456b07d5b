// SPDX-License-Identifier: Apache-2.0
// A wall at rest.
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {

Condition conditions::no_slip() {
  return {.name = "no-slip", .about = "no-slip: wall at rest", .wall = true};
}

}  // namespace couplet::fluid
