// SPDX-License-Identifier: Apache-2.0
#include "common/contact/contact.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/fv/expression.hpp"

namespace couplet::contact {

void declare(config::Section& s, ContactParameters& c, const char* default_direction) {
  s.value("height", c.height)
      .unit("m", 1e-9, 1e4)
      .doc(
          "height of the seat along 'direction', an expression of the coordinates x, y, z of the structure at rest");
  s.value("gap", c.gap)
      .doc(
          "gap of the coupled fluid to which this seat belongs: its 'height', 'opening' and 'direction' are used here");
  s.value("opening", c.opening)
      .unit("m", 1e-8, 10)
      .not_negative()
      .doc(
          "opening below which the cells of the gap are blocked. The structure lands half of this distance above the seat, so "
          "that these cells keep a volume. With 'gap', the opening of the fluid's gap is used");
  s.value("where", c.where).doc("the seat exists where this expression of x, y, z is positive");
  s.value("direction", c.direction)
      .size(3)
      .doc(fmt::format("vector of any length that points from the seat to the structure; default: {}",
                       default_direction));
  s.value("scale", c.scale)
      .positive()
      .doc("factor f_SI in the contact stiffness kappa = f_SI K S / h, thesis (4.33)");
  s.value("stiffness", c.stiffness)
      .unit("N/m^3", 1, 1e16)
      .positive()
      .doc("contact force per area and penetration depth, instead of (4.33)");
  s.value("starts-inside", c.starts_inside)
      .doc(
          "true: the structure may start inside the seat, whose springs then push from the start; false: this is an error");
  s.choice("rule", c.rule, {{"conserving", ContactRule::conserving}, {"midpoint", ContactRule::midpoint}})
      .doc(
          "conserving: a bounce conserves the energy to round-off; only with the trapezoidal time scheme. midpoint: the "
          "contact force is evaluated where the time scheme satisfies equilibrium; with any scheme");
  const auto problem = [](const config::ExpressionText& text) -> std::string {
    return fv::Expression(text).uses_time() ? "the seat is at rest: use an expression of x, y, z, without t"
                                            : "";
  };
  s.check(
      [&] {
        return c.stiffness && c.scale != 1
                   ? "it has no effect with 'stiffness', because it only scales (4.33)"
                   : "";
      },
      "scale");
  s.check([&] { return problem(c.height); }, "height");
  s.check([&] { return problem(c.where); }, "where");
  s.check(
      [&] {
        const auto& d = c.direction;
        return !d.empty() && !(std::hypot(d[0], d[1], d[2]) > 0)
                   ? "a direction is needed, not the zero vector"
                   : "";
      },
      "direction");
}

}  // namespace couplet::contact
