// SPDX-License-Identifier: Apache-2.0
// What leaves comes in at the partner: the mesh is joined there, no face of the boundary is left.
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {
namespace {

void declare_periodic(config::Section& s, BoundaryParameters& b) {
  s.value("partner", b.partner).required().doc("the patch that is a translated copy of this one");
}

}  // namespace

Condition conditions::periodic() {
  return {.name = "periodic",
          .about = "periodic: outflow re-enters at the partner",
          .declare = declare_periodic,
          .velocity = GivenBy::nobody,
          .joined = true};
}

}  // namespace couplet::fluid
