// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::contact {

enum class ContactRule {
  conserving,  ///< force of a step = change of the penalty's energy over that of the gap [gonzalez2000]
  midpoint,    ///< force of the penetration where the scheme asks for equilibrium, thesis (4.32)
};

/// A rigid seat without friction, thesis (4.32)-(4.33).
struct ContactParameters {
  config::ExpressionText height;              ///< of the seat along `direction` [m], of x, y, z
  std::string gap;                            ///< of the fluid, whose seat this is; empty: none
  double opening = 0;                         ///< of that gap [m]: what lands stays half of it above the seat
  config::ExpressionText where{.text = "1"};  ///< of x, y, z: there is a seat where it is above 0
  std::vector<double> direction;              ///< from the seat to the structure; empty: not given
  double scale = 1;                           ///< f_SI of (4.33)
  std::optional<double> stiffness;            ///< kappa per area [N/m^3]; absent: (4.33)
  bool starts_inside = false;                 ///< the structure may stand in the seat at the start
  ContactRule rule = ContactRule::conserving;
};

/// The same keys for all structures. `default_direction`: what stands for an absent `direction`.
void declare(config::Section& section, ContactParameters& parameters, const char* default_direction);

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
