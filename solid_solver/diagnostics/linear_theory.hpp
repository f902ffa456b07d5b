// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "common/diagnostics/finding.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/motion/solid_stepper.hpp"
#include "solid_solver/output/modal_analysis.hpp"

namespace couplet::solid {

/// Change of the displacement u1 of a linear static solution by large strain, under dead loads. With the
/// forces F(u) = K u + Q(u, u) + C(u, u, u) + ..., the solution under lambda times the load is lambda u1 +
/// lambda^2 u2 + lambda^3 u3 + ... [koiter1970]:
///   K u2 = -Q(u1, u1),   K u3 = -2 Q(u1, u2) - C(u1, u1, u1).
/// The part of u3 along u2, r = <u3, u2>/<u2, u2>, continues as a geometric series, as in a column at the
/// share r of its buckling load. The rest w = u3 - r u2 gives a = <w, u1>/<u1, u1>, and the amplitude obeys x
/// - a x^3 = 1:
///   u = x u1 + x^2 u2/(1 - r) + x^3 (w - a u1), for example a < 0 in a held beam that stretches.
struct LargeStrainEstimate {
  /// |u - u1|/|u1|, root mean square over the cells, of the displacement or, if larger, of a component of at least a tenth of
  /// it; NaN without equilibrium (r >= 1 or a > 4/27).
  double change = 0;
  int component = -1;  ///< component to which `change` belongs; -1 means the displacement
  double ratio = 0;    ///< r
  double cubic = 0;    ///< a
  bool is_known() const { return change == change; }
  /// Describes the change in one sentence.
  std::string text() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(change, component, ratio, cubic);
  }
};

/// Looks for such a change in a solution whose steepest gradient exceeds `gradient_seen` by a tenth, which is updated. Four
/// evaluations of the forces bound the parts of u1 in Q and C, before a held body yields to them; only if these and the
/// gradient allow a change of 2 %, u2 and u3 are solved for. Empty otherwise. `unknowns`, `known`: linear solution by `method`.
/// Laws: Saint Venant-Kirchhoff (in plane stress with its constants, which is exact), or nearly incompressible neo-Hookean with
/// the volume strain of cells. Throws SolveFailure. Collective.
std::optional<LargeStrainEstimate> estimate_large_strain(const SolidBody& body, SolutionMethod& method,
                                                         std::span<const double> unknowns,
                                                         std::span<const double> known,
                                                         double& gradient_seen);

/// Lowest load factor of a linear static run, if it is low.
struct BucklingEstimate {
  /// Limit of the neglected growth of the displacement. The buckling shape's part of it grows by 1/(factor -
  /// 1).
  static constexpr double most_growth = 0.2;
  /// Factors up to this one are searched for, because the growth may exceed the limit.
  static constexpr double low = 1 + 1 / most_growth;
  static constexpr double imperfect = 3;  ///< below it, imperfections grow by half: always reported
  double factor = 0;  ///< upper bound of lambda; 0 if not searched for, none, or not below `low`
  double growth = 0;  ///< relative growth of the displacement
  int iterations = 0;
  bool matters() const { return factor > 0 && (factor < imperfect || growth > most_growth); }
};

/// Finding about the buckling load if it matters; `how` is the text before the load factor.
std::optional<diagnostics::Finding> buckling_finding(const BucklingEstimate& found, const char* how);
/// Finding for a body in motion, never `wrong`, because inertia may outlast a short load.
std::optional<diagnostics::Finding> dynamic_buckling_finding(const BucklingEstimate& found);

/// Searches for a factor below `low`: conjugate gradients on K + low K_sigma, preconditioned by `method`,
/// then meet a negative curvature. Costs about one loose solve, and a tenth of that where a few refinements
/// of the least factor stay far above `low`. Skipped if the compression is far below the
/// buckling strain of such a slender body, 0.2 (t/L)^2 for a clamped column, or hardly exceeds
/// `compression_seen` [Pa], which is updated. Collective.
BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields,
                                   const SolidStepper& stepper, SolutionMethod& method,
                                   double& compression_seen);

}  // namespace couplet::solid
