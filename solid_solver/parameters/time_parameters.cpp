// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/time_parameters.hpp"

namespace couplet::solid {

void declare(config::Section& s, SolidDamping& d) {
  s.value("mass", d.mass)
      .unit("1/s")
      .plausible(1e-9, 1e9)
      .not_negative()
      .doc("Rayleigh coefficient of the mass matrix");
  s.value("stiffness", d.stiffness)
      .unit("s")
      .plausible(1e-15, 1e4)
      .not_negative()
      .doc("Rayleigh coefficient of the stiffness matrix");
}

void declare(config::Section& s, TimeStepControl& c) {
  s.value("tolerance", c.tolerance)
      .unit("m")
      .plausible(1e-15, 1)
      .positive()
      .required()
      .doc("target accuracy of the displacement, rms over the volume; one step may contribute a tenth of it");
}

}  // namespace couplet::solid
