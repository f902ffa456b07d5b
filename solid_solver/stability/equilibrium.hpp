// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {

/// Whether the equilibria that a static run at large strain finds hold: the least x . K x of the tangent K over that of the
/// undeformed elastic body is 1 without load, passes through zero where stability is lost, and is negative beyond.
class EquilibriumWatch {
 public:
  /// Of the step between solve and acceptance. Tells an equilibrium that does not hold once, with the load at which stability was
  /// lost. Collective.
  void see(const SolidBody& body, const SolidStepper& stepper, const SolidFields& fields);
  /// After acceptance, of a run by arc length: limit points of load that it has passed. Collective.
  void follow(const SolidBody& body, const SolidFields& fields);
  /// At its end: whether the last equilibrium holds; the limit loads of the path in words.
  void finish(const SolidBody& body, std::vector<std::string>& sentences) const;
  /// For checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(time_, stiffness_, load_, is_told_, limits_told_);
    if (numbers.reads()) softest_ = {};
  }
  /// Of the last step; under control of the load, which alone makes what is soft err more.
  const SoftMotion& softest() const { return softest_; }

 private:
  double time_ = 0, stiffness_ = 1;  // of the last equilibrium that held
  Vec3 load_ = Vec3::Zero();
  SoftMotion softest_;
  bool is_told_ = false;
  std::size_t limits_told_ = 0;
};

}  // namespace couplet::solid
