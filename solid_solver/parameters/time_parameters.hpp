// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"
#include "common/time/time_scheme.hpp"

namespace couplet::solid {

/// Rayleigh damping C = mass M + stiffness K, thesis (2.79).
struct SolidDamping {
  double mass = 0;       // [1/s]
  double stiffness = 0;  // [s]
};

/// Step sizes that follow the local error.
struct TimeStepControl {
  double tolerance = 0;  // wanted accuracy of the displacement, rms over the volume [m]
};

void declare(config::Section& section, SolidDamping& damping);
void declare(config::Section& section, TimeStepControl& control);

}  // namespace couplet::solid
