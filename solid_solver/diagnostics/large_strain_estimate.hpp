// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "solid_solver/body/solid_body.hpp"

namespace couplet::solid {

/// By how much large strain would change the displacement u1 of a linear static solution, the loads being dead.
/// With the forces F(u) = K u + Q(u, u) + C(u, u, u) + ... of the symmetric gradient at large strain the solution under
/// lambda times the load is lambda u1 + lambda^2 u2 + lambda^3 u3 + ... [koiter1970],
///   K u2 = -Q(u1, u1),   K u3 = -2 Q(u1, u2) - C(u1, u1, u1).
/// Summed beyond that as what such series are where they are known: with r = <u3, u2> / <u2, u2> and u3 = r u2 + w the
/// part along u2 is geometric (a column under r of its buckling load: u2 (1 + r + r^2 + ...)), and with a = <w, u1> /
/// <u1, u1> the amplitude x obeys x - a x^3 = 1 (a held beam that stretches: a < 0):
///   u = x u1 + x^2 u2 / (1 - r) + x^3 (w - a u1).
struct LargeStrainEstimate {
  double change =
      0;  ///< |u - u1| / |u1|, root mean square over the cells; NaN: r >= 1 or a > 4/27, no equilibrium
  double ratio = 0;  ///< r
  double cubic = 0;  ///< a
  bool is_known() const { return change == change; }
  /// One sentence with the number.
  std::string text() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(change, ratio, cubic);
  }
};

/// Two linear solves and some evaluations of the forces, with an operator of its own. `unknowns`, `known`: of the linear
/// solution. Laws: Saint Venant-Kirchhoff, or nearly incompressible neo-Hookean where the volume strain is the cells'.
/// Throws SolveFailure. Collective.
LargeStrainEstimate estimate_large_strain(const SolidBody& body, std::span<const double> unknowns,
                                          std::span<const double> known);

}  // namespace couplet::solid
