// SPDX-License-Identifier: Apache-2.0
// The fluid leaves with the velocity that the mean outflow carries to the patch: Boundary::convect().
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {

Condition conditions::convective_outlet() {
  return {.name = "convective-outlet",
          .about = "convective-outlet: the flow leaves with the mean outflow speed, with zero mean pressure",
          .velocity = GivenBy::flow,
          .passage = Passage::out};
}

}  // namespace couplet::fluid
