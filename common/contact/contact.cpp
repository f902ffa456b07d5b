// SPDX-License-Identifier: Apache-2.0
#include "common/contact/contact.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/fv/expression.hpp"

namespace couplet::contact {

void declare(config::Section& s, ContactParameters& c, const char* default_direction) {
  s.value("height", c.height)
      .unit("m", 1e-9, 1e4)
      .doc("height of the seat along 'direction', of x, y, z of the structure at rest");
  s.value("gap", c.gap)
      .doc(
          "gap of the coupled fluid whose seat this is: 'height', 'opening' and 'direction' are taken from there");
  s.value("opening", c.opening)
      .unit("m", 1e-8, 10)
      .not_negative()
      .doc(
          "opening below which the gap's cells are blocked: the structure lands half of it above the seat, so that they keep "
          "a volume; with 'gap' that of the fluid's gap");
  s.value("where", c.where).doc("the seat exists where this expression of x, y, z is above 0");
  s.value("direction", c.direction)
      .size(3)
      .doc(fmt::format("direction from the seat to the structure, of any length; default: {}",
                       default_direction));
  s.value("scale", c.scale).positive().doc("f_SI of thesis (4.33): kappa = f_SI K S / h");
  s.value("stiffness", c.stiffness)
      .unit("N/m^3", 1, 1e16)
      .positive()
      .doc("force per area and penetration, instead of (4.33)");
  s.value("starts-inside", c.starts_inside)
      .doc(
          "the structure may start inside the seat, whose springs then push from the start; false: an error");
  s.choice("rule", c.rule, {{"conserving", ContactRule::conserving}, {"midpoint", ContactRule::midpoint}})
      .doc(
          "conserving: a bounce conserves the energy to rounding, with the trapezoidal time scheme only; "
          "midpoint: the force where the scheme has equilibrium, with any scheme");
  const auto problem = [](const config::ExpressionText& text) -> std::string {
    return fv::Expression(text).uses_time() ? "the seat is at rest: use an expression of x, y, z, without t"
                                            : "";
  };
  s.check(
      [&] {
        return c.stiffness && c.scale != 1 ? "it has no effect with 'stiffness': it scales (4.33) only" : "";
      },
      "scale");
  s.check([&] { return problem(c.height); }, "height");
  s.check([&] { return problem(c.where); }, "where");
  s.check(
      [&] {
        const auto& d = c.direction;
        return !d.empty() && !(std::hypot(d[0], d[1], d[2]) > 0) ? "a direction is needed, not 0" : "";
      },
      "direction");
}

}  // namespace couplet::contact
