// SPDX-License-Identifier: Apache-2.0
// A surface without friction that the fluid does not cross; it moves with the mesh. A plane of symmetry is the same.
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {

Condition conditions::slip() {
  return {.name = "slip",
          .about = "slip, symmetry: no normal flow, no friction",
          .row = [](const BoundaryParameters&) { return FaceRow{.slip_length = no_friction}; },
          .velocity = GivenBy::mesh};
}

Condition conditions::symmetry() {
  Condition same = slip();
  same.name = "symmetry";
  same.about.clear();
  return same;
}

}  // namespace couplet::fluid
