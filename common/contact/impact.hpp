// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/contact/contact_parameters.hpp"

namespace couplet::contact {

/// Force over kappa [m], and its derivative by the penetration.
struct Push {
  double force = 0, slope = 0;
};

/// (4.32): the penetration delta where the scheme asks for equilibrium.
inline Push push(double delta) { return {std::max(delta, 0.), delta > 0 ? 1. : 0.}; }

/// Mean force of a step from `before` to `now`, (V(now) - V(before)) / (now - before) with V = <delta>^2 / 2, so that the
/// work is the change of the energy whatever the step [gonzalez2000]. It grows with `now`: one solution.
inline Push push(double before, double now) {
  if (now > 0 && before > 0) return {0.5 * (now + before), 0.5};
  if (now > 0)  // it arrives
    return {0.5 * now * now / (now - before),
            0.5 * now * (now - 2 * before) / ((now - before) * (now - before))};
  if (before > 0)  // it leaves
    return {0.5 * before * before / (before - now),
            0.5 * before * before / ((before - now) * (before - now))};
  return {};
}

}  // namespace couplet::contact
