// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing {

/// A rigid seat at y = `height` below a body.
inline contact::ContactParameters seat_below(const std::string& height) {
  contact::ContactParameters c;
  c.height.text = height;
  c.direction = {0, 1, 0};
  return c;
}

/// What the seat feels at the accepted state: of a rigid one what the last solve found.
inline Seat::Look look(const Solid& solid) {
  const Seat& seat = *solid.body().seat();
  const SolidState& s = solid.stepper().state();
  return seat.look(seat.penetration(solid.body().unknowns_of(s.cell_u, s.face_u), s.known),
                   seat.is_rigid() ? solid.stepper().last_solve().contact : std::vector<double>());
}

/// A column on its seat that can move up and down alone: waves of one dimension.
inline SolidParameters column(int dim) {
  SolidParameters p = box_parameters(dim);
  p.material = {1000, 1e7, 0.3};
  for (const char* side : {"xmin", "xmax"}) p.boundaries[side] = boundary(Type::symmetry);
  if (dim == 3)
    for (const char* side : {"zmin", "zmax"}) p.boundaries[side] = boundary(Type::symmetry);
  return p;
}

}  // namespace couplet::testing
