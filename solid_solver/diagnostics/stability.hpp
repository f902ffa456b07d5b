// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {

/// Tells whether the equilibria that a static run at large strain finds hold: the least x . K x of the tangent K over that
/// of the undeformed elastic body is 1 without load, passes through zero where stability is lost, and is negative beyond.
/// Tells the first that does not hold with the load at which stability was lost; of a run by arc length the limit points of
/// load that it has passed, and whether the last equilibrium holds.
class Stability final : public diagnostics::Diagnostic {
 public:
  explicit Stability(const SolidView& view) : view_(view) {}
  void observe(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;
  /// Softest motion of the last step under control of the load, which alone makes what is soft err more.
  const SoftMotion& softest() const { return softest_; }

 private:
  void see_limits(const LoadPath& path);

  SolidView view_;
  double time_ = 0, stiffness_ = 1;  // of the last equilibrium that held
  Vec3 load_ = Vec3::Zero();
  SoftMotion softest_;
  bool is_lost_ = false;
  std::size_t limits_told_ = 0;
};

}  // namespace couplet::solid
