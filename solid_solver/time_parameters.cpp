// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/time_parameters.hpp"

namespace couplet {

void declare(config::Section& s, SolidDamping& d) {
  s.value("mass", d.mass).unit("1/s").not_negative().doc("Rayleigh coefficient of the mass matrix");
  s.value("stiffness", d.stiffness)
      .unit("s")
      .not_negative()
      .doc("Rayleigh coefficient of the stiffness matrix");
}

}  // namespace couplet
