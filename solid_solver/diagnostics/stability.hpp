// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {

/// Checks the stability of the equilibria of a static run at large strain. The smallest x . K x of the
/// tangent K over that of the undeformed body is 1 without load, zero at the loss of stability and negative
/// beyond. Reports the load of the first loss. With arc length, reports the limit points passed and whether
/// the last equilibrium is stable.
class Stability final : public diagnostics::Diagnostic {
 public:
  explicit Stability(const SolidView& view) : view_(view) {}
  void observe(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;
  /// Softest motion of the last load-controlled step. Only there does a soft motion amplify errors.
  const SoftMotion& softest() const { return softest_; }

 private:
  void see_limits(const LoadPath& path);

  SolidView view_;
  double time_ = 0, stiffness_ = 1;  // of the last stable equilibrium
  Vec3 load_ = Vec3::Zero();
  SoftMotion softest_;
  bool is_lost_ = false;
  std::size_t limits_told_ = 0;
};

}  // namespace couplet::solid
