// SPDX-License-Identifier: Apache-2.0
// The fluid comes in with a velocity that the case gives. Of a compressible fluid it may let pressure waves out
// (pressure/absorbing), or lie before a volume (pressure/upstream_volume).
#include "fluid_solver/conditions/keys.hpp"

namespace couplet::fluid {
namespace {

void declare_inlet(config::Section& s, BoundaryParameters& b) {
  declare_velocity(s, b);
  s.value("mean-speed", b.mean_speed)
      .unit("m/s")
      .plausible(1e-9, 1e4)
      .doc("instead of 'velocity': mean normal speed into the domain, an expression of t [s]");
  s.choice("profile", b.profile, {{"uniform", InletProfile::uniform}, {"parabolic", InletProfile::parabolic}})
      .doc("for mean-speed; parabolic: zero at the rim of the patch, a straight line in 2-D, a disc in 3-D");
  declare_ramp(s, b);
  declare_table_and_rotation(s, b);
  declare_absorbing(s, b);
  s.check(
      [&b] {
        const int given = !b.velocity.empty() + b.mean_speed.has_value() + b.table.has_value();
        if (given != 1) return std::string("give either 'velocity', 'mean-speed' or 'table'");
        if (b.profile == InletProfile::parabolic && !b.mean_speed)
          return std::string(
              "'profile: parabolic' requires 'mean-speed'; use 'mean-speed', or remove 'profile'");
        return std::string();
      },
      "type");
}

}  // namespace

Condition conditions::inlet() {
  return {.name = "inlet",
          .about = "inlet: prescribed velocity",
          .declare = declare_inlet,
          .velocity = GivenBy::keys,
          .passage = Passage::in};
}

}  // namespace couplet::fluid
