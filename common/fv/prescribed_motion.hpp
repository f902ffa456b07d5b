// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/expression.hpp"
#include "common/fv/use.hpp"

namespace couplet::fv {

/// Keys of a prescribed motion.
struct MotionParameters {
  std::vector<config::ExpressionText> translation;   // [m], function of t
  config::ExpressionText angle;                      // [rad], function of t
  std::vector<config::ExpressionText> displacement;  // [m], function of the reference position and t
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();  // [m]; of the rotation
  double inner_radius = 0;                           // [m]
  std::optional<double> outer_radius;                // [m]; if absent, everything moves
  /// Returns true if the motion is a pure translation.
  bool translates() const { return displacement.empty() && !outer_radius && angle.text == "0"; }
};

/// `with_radii` adds the keys inner-radius and outer-radius.
void declare(config::Section& section, MotionParameters& parameters, bool with_radii);

/// Throws Error with the key if the rotation axis in 2-D is not z.
void check_axis(const Vec3& axis, int dim, const std::string& key);

/// Prescribed motion of points: a whole mesh, an embedded body, or a wall:
///   X(x, t) = c + R(s phi(t)) (x - c) + s [T(t) + d(x, t)]
/// with center c, angle phi, translation T and displacement field d. s = 1 everywhere (rigid mesh, except for
/// d), or s = 1 up to the inner radius about c with a smooth decay to 0 at the outer one. No equation is
/// solved.
class PrescribedMotion {
 public:
  /// Throws Error for expressions that cannot be parsed.
  PrescribedMotion(const MotionParameters& parameters, int dim);

  /// Positions at time t of points in the reference configuration [m].
  std::vector<Vec3> places(std::span<const Vec3> reference, double t) const;
  /// Velocities [m/s] from three positions at most `dt` back, second-order in dt / 1000.
  std::vector<Vec3> velocities(std::span<const Vec3> reference, double t, double dt) const;
  /// Velocities at the start of the motion [m/s], from later positions only. Zero if they grow from rest.
  /// `length` is the size of the scene [m]; a millionth of it is a small displacement.
  std::vector<Vec3> starting_velocities(std::span<const Vec3> reference, double t, double length) const;
  /// Largest displacement at time t on this rank [m].
  double largest_displacement(std::span<const Vec3> reference, double t) const;

 private:
  double share(const Vec3& x) const;

  MotionParameters parameters_;
  std::vector<Expression> translation_, displacement_;
  Expression angle_;
  Use* use_;
};

}  // namespace couplet::fv
