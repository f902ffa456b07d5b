// SPDX-License-Identifier: Apache-2.0
// A wall at rest along which the fluid slides the faster the more it is sheared, u = L du/dn [navier1823].
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {
namespace {

void declare_partial_slip(config::Section& s, BoundaryParameters& b) {
  s.value("slip-length", b.slip_length)
      .unit("m")
      .plausible(1e-10, 10)
      .positive()
      .required()
      .doc("distance behind the wall at which the velocity along it, continued, is zero: u = L du/dn");
}

}  // namespace

Condition conditions::partial_slip() {
  return {.name = "partial-slip",
          .about = "partial-slip: wall at rest with a slip length (Navier)",
          .declare = declare_partial_slip,
          .row = [](const BoundaryParameters& b) { return FaceRow{.slip_length = b.slip_length}; },
          .wall = true};
}

}  // namespace couplet::fluid
