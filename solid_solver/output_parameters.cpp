// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output_parameters.hpp"

namespace couplet {

void declare(config::Section& s, SolidProbe& p) {
  s.value("point", p.point).required().doc("place in the undeformed solid [m]");
}

void declare(config::Section& s, SolidOutputParameters& o) {
  s.value("deformed", o.deformed).doc("write the mesh points where they have moved to");
  s.value("stress", o.stress).doc("write stress components and the equivalent stress");
}

}  // namespace couplet
