// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::contact {

enum class ContactRule {
  conserving,  ///< mean force of a step = change of penalty energy / change of gap [gonzalez2000]
  midpoint,    ///< force of the penetration at the point of equilibrium of the scheme, thesis (4.32)
};

/// Rigid frictionless obstacle ("seat"), thesis (4.32)-(4.33).
struct ContactParameters {
  config::ExpressionText height;              ///< of the seat along `direction` [m], function of x, y, z
  std::string gap;                            ///< gap of the fluid at this seat; empty if there is none
  double opening = 0;                         ///< of that gap [m]; contact keeps half of it above the seat
  config::ExpressionText where{.text = "1"};  ///< function of x, y, z: the seat exists where it is above 0
  std::vector<double> direction;              ///< from the seat to the structure; empty if not given
  double scale = 1;                           ///< f_SI of (4.33)
  std::optional<double> stiffness;            ///< kappa per area [N/m^3]; (4.33) if absent
  bool starts_inside = false;                 ///< allows penetration at the start
  ContactRule rule = ContactRule::conserving;
};

/// Declares the keys of all structures. `default_direction` documents an absent `direction`.
void declare(config::Section& section, ContactParameters& parameters, const char* default_direction);

/// Contact force over kappa [m] and its derivative with respect to the penetration.
struct ContactForce {
  double force = 0, slope = 0;
};

/// Contact force of (4.32) for the penetration delta at the point of equilibrium of the scheme.
inline ContactForce push(double delta) { return {std::max(delta, 0.), delta > 0 ? 1. : 0.}; }

/// Mean force of a step from `before` to `now`, (V(now) - V(before)) / (now - before) with V = <delta>^2 / 2.
/// Its work equals the change of energy for any step [gonzalez2000]. It grows with `now`: unique solution.
inline ContactForce push(double before, double now) {
  if (now > 0 && before > 0) return {0.5 * (now + before), 0.5};
  if (now > 0)  // contact begins
    return {0.5 * now * now / (now - before),
            0.5 * now * (now - 2 * before) / ((now - before) * (now - before))};
  if (before > 0)  // contact ends
    return {0.5 * before * before / (before - now),
            0.5 * before * before / ((before - now) * (before - now))};
  return {};
}

}  // namespace couplet::contact
