// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solid_solver/analysis/modal_analysis.hpp"
#include "solid_solver/diagnostics/view.hpp"

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

/// Bounds the factor by a few refinements of a soft motion, or where it `searches` looks for any below `low`: conjugate gradients on K + low K_sigma, preconditioned by `method`,
/// then meet a negative curvature. Costs about one loose solve, and a tenth of that where a few refinements
/// of the least factor stay far above `low`. Skipped if the compression is far below the
/// buckling strain of such a slender body, 0.2 (t/L)^2 for a clamped column, or hardly exceeds
/// `compression_seen` [Pa], which is updated. Collective.
BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields,
                                   const SolidStepper& stepper, SolutionMethod& method,
                                   double& compression_seen, bool searches);

/// Buckling of a linear body. A few refinements bound the load factor; a search that finds every low one is on request.
class LinearBuckling final : public diagnostics::Diagnostic {
 public:
  LinearBuckling(const SolidView& view, bool searches) : view_(view), searches_(searches) {}
  void observe(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;
  /// Lowest load factor of the run; NaN unless it is low.
  double factor() const;

 private:
  void see(diagnostics::Report& report);

  SolidView view_;
  bool searches_;
  double factor_ = BucklingEstimate::low;
  double compression_seen_ = 0;  // at the last look [Pa]
};

}  // namespace couplet::solid
