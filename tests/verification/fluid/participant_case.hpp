// SPDX-License-Identifier: Apache-2.0
// A fluid alone as a participant: steps and the moment on its walls.
#pragma once

#include "fluid_solver/output/derived.hpp"
#include "fluid_solver/participant.hpp"
#include "tests/support/test.hpp"

namespace couplet::fluid::test {

/// The steps numbered begin, begin + 1, ... before end.
inline void take_steps(FluidParticipant<2>& run, int begin, int end, double dt = 0.02) {
  for (int i = begin; i < end; ++i) {
    run.begin_step({dt * i, dt, coupling::Scheme::standalone, i});
    run.solve({});
    run.accept_step();
  }
}

/// About the origin [N m/m].
inline double moment(const Fluid<2>& fluid, const std::vector<std::string>& patches) {
  CoefficientParameters wanted;
  wanted.patches = patches;
  wanted.speed = std::sqrt(2.0);  // rho/2 U^2 A L = 1
  return force_coefficients(fluid, wanted).moment;
}

}  // namespace couplet::fluid::test
