// SPDX-License-Identifier: Apache-2.0
// A fluid alone as a participant: steps and the moment on its walls.
#pragma once

#include "common/parallel/collective.hpp"
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

/// Largest difference of the cells' velocities between a run and one that has the whole mesh on this rank.
inline double apart(const FluidParticipant<2>& run, const FluidParticipant<2>& whole) {
  const auto &cells = run.fluid().mesh(), &all = whole.fluid().mesh();
  std::vector<Vec<2>> by_id(all.cells.n_global());
  for (Index c = 0; c < all.cells.n_owned(); ++c) by_id[all.cell_id[c]] = whole.fluid().state().u[c];
  double largest = 0;
  for (Index c = 0; c < cells.cells.n_owned(); ++c)
    largest = std::max(largest, (run.fluid().state().u[c] - by_id[cells.cell_id[c]]).norm());
  return parallel::max(MPI_COMM_WORLD, largest);
}

/// About the origin [N m/m].
inline double moment(const Fluid<2>& fluid, const std::vector<std::string>& patches) {
  CoefficientParameters wanted;
  wanted.patches = patches;
  wanted.speed = std::sqrt(2.0);  // rho/2 U^2 A L = 1
  return force_coefficients(fluid, wanted).moment;
}

}  // namespace couplet::fluid::test
