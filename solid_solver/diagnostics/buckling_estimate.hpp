// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/diagnostics/finding.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/output/buckling.hpp"

namespace couplet::solid {

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
/// then meet a negative curvature. Costs about one loose solve. Skipped if the compression is far below the
/// buckling strain of such a slender body, 0.2 (t/L)^2 for a clamped column, or hardly exceeds
/// `compression_seen` [Pa], which is updated. Collective.
BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields, const SolidState& state,
                                   SolutionMethod& method, double& compression_seen);

}  // namespace couplet::solid
