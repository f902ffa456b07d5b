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

void declare(config::Section& s, TimeStepControl& c) {
  s.value("tolerance", c.tolerance)
      .unit("m")
      .positive()
      .required()
      .doc("wanted accuracy of the displacement, rms over the volume; one step may add a tenth of it");
}

}  // namespace couplet
