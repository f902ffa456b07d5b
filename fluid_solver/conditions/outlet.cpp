// SPDX-License-Identifier: Apache-2.0
// The fluid leaves at a pressure that the case gives. What comes in through it carries half of its velocity, so that its share
// of the kinetic energy vanishes, phi (u_b - u_P/2).u_P = 0.
#include "fluid_solver/conditions/keys.hpp"

namespace couplet::fluid {
namespace {

void declare_outlet(config::Section& s, BoundaryParameters& b) {
  s.value("pressure", b.pressure).unit("Pa").plausible(1e-9, 1e11).doc("expression of x, y, z [m] and t [s]");
  s.value("backflow-stabilisation", b.backflow_stabilisation)
      .doc("inflow here carries no kinetic energy; without it strong backflow may grow");
  declare_absorbing(s, b);
}

}  // namespace

Condition conditions::outlet() {
  return {.name = "outlet",
          .about = "outlet: prescribed pressure",
          .declare = declare_outlet,
          .row =
              [](const BoundaryParameters& b) {
                return FaceRow{1, no_friction, b.backflow_stabilisation ? 0.5 : 1.0};
              },
          .velocity = GivenBy::nobody,
          .passage = Passage::out};
}

}  // namespace couplet::fluid
