// SPDX-License-Identifier: Apache-2.0
// A wall that moves as prescribed, across itself too.
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {

Condition conditions::body() {
  return {
      .name = "body",
      .about =
          "body: wall that moves by 'motion', or by its own motion in the mesh mover (type: moving there)",
      .velocity = GivenBy::motion,
      .wall = true};
}

}  // namespace couplet::fluid
