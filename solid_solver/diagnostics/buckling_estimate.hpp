// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/diagnostics/finding.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/output/buckling.hpp"

namespace couplet::solid {

/// The lowest load factor of a linear static run, if it is low.
struct BucklingEstimate {
  /// What moves as the buckling shape grows by 1/(factor - 1) of itself, which a linear answer neglects: this much of the displacement
  /// is told.
  static constexpr double most_growth = 0.2;
  static constexpr double low =
      1 + 1 / most_growth;                ///< up to here the growth may be so large: looked for below
  static constexpr double imperfect = 3;  ///< below it imperfections grow by a half: told whatever moves
  double factor = 0;  ///< an upper bound of lambda; 0: not looked for, none, or not below `low`
  double growth = 0;  ///< of the displacement, over its size
  int iterations = 0;
  bool matters() const { return factor > 0 && (factor < imperfect || growth > most_growth); }
};

/// The finding on it, where it matters; `how` goes before its factor.
std::optional<diagnostics::Finding> buckling_finding(const BucklingEstimate& found, const char* how);
/// The same of a body in motion, whose inertia may outlast a short load: never `wrong`.
std::optional<diagnostics::Finding> dynamic_buckling_finding(const BucklingEstimate& found);

/// Conjugate gradients on K + low K_sigma with the preconditioner of `method` meet a negative curvature where the factor is below
/// `low`: one loose solution more. Nothing is done where the compression is far
/// below what buckles a body as slender as this, 0.2 (t/L)^2 of strain for a clamped column, or hardly more than
/// `compression_seen` [Pa], which it then becomes. Collective.
BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields, const SolidState& state,
                                   SolutionMethod& method, double& compression_seen);

}  // namespace couplet::solid
