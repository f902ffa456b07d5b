// SPDX-License-Identifier: Apache-2.0
// A plate in a square that moves as told, for the tests of the mover.
#pragma once

#include "mesh_mover/mover.hpp"
#include "tests/support/own_folder.hpp"
#include "tests/support/test.hpp"

namespace couplet::mesh_mover::test {

inline double largest_difference(MPI_Comm comm, const std::vector<double>& a, const std::vector<double>& b) {
  double worst = a.size() == b.size() ? 0 : 1e300;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(a[i] - b[i]));
  return parallel::max(comm, worst);
}

inline Parameters plate_in_a_square(Method method, Form form, double chi = 1) {
  Parameters p;
  p.mesh = "square.geo";
  p.mesh_parameters = {{"n", 16}};
  p.dimension = 2;
  p.method = method;
  p.form = form;
  p.stiffening = chi;
  for (const char* wall : {"floor", "right", "lid", "left"}) p.boundaries[wall].motion = BoundaryMotion::slip;
  p.boundaries["plate"].motion = BoundaryMotion::moving;
  return p;
}

inline app::ParticipantContext context() {
  app::ParticipantContext c;
  c.comm = MPI_COMM_WORLD;
  c.name = "mover";
  c.case_folder = COUPLET_CONFIGS "/moving-mesh";
  c.coupled = true;  // writes no fields
  c.output_folder = support::own_folder();
  return c;
}

inline void run(Mover& mover, double from, double to, int steps) {
  for (int i = 0; i < steps; ++i) {
    const double dt = (to - from) / steps;
    mover.begin_step({from + i * dt, dt, coupling::Scheme::standalone, i});
    mover.solve({});
    mover.accept_step();
  }
}

inline void turn_by(Parameters& p, const std::string& angle) {
  p.boundaries["plate"].prescribed.angle = {angle};
}

}  // namespace couplet::mesh_mover::test
