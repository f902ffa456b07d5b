// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "solid_solver/diagnostics/view.hpp"

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

/// Largest such change of a linear static run.
class LargeStrainChange final : public diagnostics::Diagnostic {
 public:
  explicit LargeStrainChange(const SolidView& view) : view_(view) {}
  void observe(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;
  /// Empty if it is not known or cannot matter.
  const std::optional<LargeStrainEstimate>& estimate() const { return estimate_; }
  bool is_bounded() const { return is_bounded_; }  ///< its first terms are known

 private:
  SolidView view_;
  std::optional<LargeStrainEstimate> estimate_;
  bool is_bounded_ = false;
  double gradient_seen_ = 0;  // at the last look
};

}  // namespace couplet::solid
