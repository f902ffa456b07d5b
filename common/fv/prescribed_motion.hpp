// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/config/section.hpp"
#include "common/fv/expression.hpp"

namespace couplet::fv {

/// Keys of a prescribed motion.
struct MotionParameters {
  std::vector<config::ExpressionText> translation;   // [m], of t
  config::ExpressionText angle;                      // [rad], of t
  std::vector<config::ExpressionText> displacement;  // [m], of the reference place and t
  Vec3 centre = Vec3::Zero(), axis = Vec3::UnitZ();  // [m]; of the rotation
  double inner_radius = 0;                           // [m]
  std::optional<double> outer_radius;                // [m]; absent: everything moves
  /// Everything is only translated.
  bool translates() const { return displacement.empty() && !outer_radius && angle.text == "0"; }
};

/// `with_radii`: the keys inner-radius and outer-radius, too.
void declare(config::Section& section, MotionParameters& parameters, bool with_radii);

/// In the plane the axis of a rotation is that of z, or Error that names the key.
void check_axis(const Vec3& axis, int dim, const std::string& key);

/// A motion that the case prescribes, of points: a whole mesh, a body in its midst, or a wall:
///   X(x, t) = c + R(s phi(t)) (x - c) + s [T(t) + d(x, t)]
/// about the centre c, by the angle phi, the translation T and the displacement field d. s = 1 everywhere
/// (rigid mesh, d apart), or 1 up to the inner radius about c and smoothly 0 from the outer one on: the body
/// inside moves, its surroundings follow, what is outside rests. No equation is solved.
class PrescribedMotion {
 public:
  /// Throws Error for expressions that cannot be read.
  PrescribedMotion(const MotionParameters& parameters, int dim);

  /// Places at time t of points given in the reference configuration [m].
  std::vector<Vec3> places(std::span<const Vec3> reference, double t) const;
  /// Their velocities [m/s], from three places not more than `dt` back: second order in a thousandth of dt.
  std::vector<Vec3> velocities(std::span<const Vec3> reference, double t, double dt) const;
  /// Their velocities as the motion begins at t [m/s], from places after it alone; zeros where they grow from rest.
  /// `length`: of the scene [m], a millionth of which is a small displacement.
  std::vector<Vec3> starting_velocities(std::span<const Vec3> reference, double t, double length) const;
  /// Largest displacement at time t on this rank [m].
  double largest_displacement(std::span<const Vec3> reference, double t) const;

 private:
  double share(const Vec3& x) const;

  MotionParameters parameters_;
  std::vector<Expression> translation_, displacement_;
  Expression angle_;
};

}  // namespace couplet::fv
