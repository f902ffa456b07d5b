// SPDX-License-Identifier: Apache-2.0
// A wall that moves along itself.
#include "fluid_solver/conditions/keys.hpp"

namespace couplet::fluid {
namespace {

void declare_moving_wall(config::Section& s, BoundaryParameters& b) {
  declare_velocity(s, b);
  declare_ramp(s, b);
  declare_table_and_rotation(s, b);
  s.check(
      [&b] {
        if (!b.velocity.empty() && b.table) return std::string("give either 'velocity' or 'table'");
        if (b.velocity.empty() && !b.table && !b.rotation)
          return std::string("give 'velocity', 'table' or 'rotation'");
        return std::string();
      },
      "type");
}

}  // namespace

Condition conditions::moving_wall() {
  return {.name = "moving-wall",
          .about = "moving-wall: wall with a prescribed velocity",
          .declare = declare_moving_wall,
          .velocity = GivenBy::keys,
          .wall = true};
}

}  // namespace couplet::fluid
