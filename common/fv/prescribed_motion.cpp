// SPDX-License-Identifier: Apache-2.0
#include "common/fv/prescribed_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "common/base/error.hpp"

namespace couplet::fv {
namespace {

// Fraction of the step for the difference quotient, whose error is 1e-6 of a second-order scheme's.
constexpr double backwards = 1e-3;
// Parameters of starting_velocities(): a small displacement relative to the length, and trial times [s].
constexpr double small = 1e-6, shortest = 1e-12, longest = 1;

std::vector<Expression> expressions(const std::vector<config::ExpressionText>& texts, int dim,
                                    const char* where) {
  return texts.empty() ? std::vector<Expression>{} : make_expressions(texts, dim, where);
}

}  // namespace

void declare(config::Section& s, MotionParameters& m, bool with_radii) {
  s.value("translation", m.translation)
      .unit("m", 1e-9, 1e4)
      .doc("translation, one expression of t [s] per component; default: none");
  s.value("angle", m.angle)
      .unit("rad", 1e-9, 1e4)
      .doc("rotation angle about 'centre' [rad], an expression of t [s]");
  s.value("centre", m.centre)
      .unit("m", 1e-9, 1e4)
      .doc("center of the rotation and of the radii, in the reference configuration");
  s.value("axis", m.axis).size(3).doc("axis of the rotation, 3-D; a 2-D case rotates about z");
  s.value("displacement", m.displacement)
      .unit("m", 1e-9, 1e4)
      .doc(
          "additional displacement field: one expression of x, y, z [m] in the reference configuration and "
          "t [s] per component");
  if (with_radii) {
    s.value("inner-radius", m.inner_radius)
        .unit("m", 1e-9, 1e4)
        .not_negative()
        .doc("with outer-radius: everything within this distance of the center moves as a rigid body");
    s.value("outer-radius", m.outer_radius)
        .unit("m", 1e-9, 1e4)
        .positive()
        .doc(
            "beyond this distance the mesh is at rest, and between the radii the motion decays smoothly; default: the whole "
            "mesh moves");
  }
  s.check(
      [&m] {
        const bool moves = !m.translation.empty() || m.angle.text != "0" || !m.displacement.empty();
        return moves ? "" : "nothing moves without a 'translation', an 'angle' or a 'displacement'";
      },
      "");
  s.check(
      [&m] {
        if (!m.outer_radius && m.inner_radius > 0)
          return std::string("'inner-radius' has no effect without 'outer-radius'; give both or neither");
        if (m.outer_radius && *m.outer_radius <= m.inner_radius)
          return std::string("'outer-radius' must be larger than 'inner-radius'");
        if (!(m.axis.norm() > 0)) return std::string("'axis' must not be zero");
        return std::string();
      },
      with_radii ? "outer-radius" : "axis");
}

void check_axis(const Vec3& axis, int dim, const std::string& key) {
  if (dim == 2 && (axis[0] != 0 || axis[1] != 0 || !(axis[2] > 0)))
    throw Error(
        "{}: a 2-D case rotates about z, [0, 0, 1]; for the opposite direction use a negative angle or speed.",
        key);
}

PrescribedMotion::PrescribedMotion(const MotionParameters& parameters, int dim)
    : parameters_(parameters),
      translation_(expressions(parameters.translation, dim, "motion.translation")),
      displacement_(expressions(parameters.displacement, dim, "motion.displacement")),
      angle_(parameters.angle, "motion.angle"),
      use_(&uses()["motion"]) {
  use_->given = "the motion, which moves points,";
  const auto refuse = [](const Expression& e, const char* key) {
    if (e.uses_space())
      throw Error(
          "motion.{}: '{}' depends on the position, but it is a single value for all points. Use "
          "'displacement' for a motion that varies in space.",
          key, e.text());
  };
  refuse(angle_, "angle");
  check_axis(parameters.axis, dim, "motion.axis");
  for (const Expression& e : translation_) refuse(e, "translation");
}

/// Blending function 1 - 10 q^3 + 15 q^4 - 6 q^5 between the radii, smooth at both.
double PrescribedMotion::share(const Vec3& x) const {
  if (!parameters_.outer_radius) return 1;
  const double inner = parameters_.inner_radius, outer = *parameters_.outer_radius;
  const double q = std::clamp(((x - parameters_.centre).norm() - inner) / (outer - inner), 0.0, 1.0);
  return 1 - q * q * q * (10 + q * (6 * q - 15));
}

std::vector<Vec3> PrescribedMotion::places(std::span<const Vec3> reference, double t) const {
  const double angle = angle_(Vec3::Zero(), t);
  Vec3 translation = Vec3::Zero();
  for (std::size_t c = 0; c < translation_.size(); ++c)
    translation[static_cast<int>(c)] = translation_[c](Vec3::Zero(), t);
  std::vector<Vec3> field;
  if (!displacement_.empty()) {
    field.assign(reference.size(), Vec3::Zero());
    const std::span<double> values(field.empty() ? nullptr : field.front().data(), 3 * field.size());
    for (std::size_t c = 0; c < displacement_.size(); ++c)
      displacement_[c].evaluate(reference, t, values, 3, static_cast<int>(c));
  }
  const Vec3 axis = parameters_.axis.normalized(), &centre = parameters_.centre;
  std::vector<Vec3> moved(reference.begin(), reference.end());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const double s = share(reference[i]);
    use_->note(0);
    if (s == 0) continue;
    Vec3 shift = translation;
    if (!field.empty()) shift += field[i];
    if (angle != 0) moved[i] = centre + Eigen::AngleAxisd(s * angle, axis) * (reference[i] - centre);
    moved[i] += s * shift;
    use_->note((moved[i] - reference[i]).norm());
  }
  return moved;
}

std::vector<Vec3> PrescribedMotion::velocities(std::span<const Vec3> reference, double t, double dt) const {
  const double h = backwards * dt;
  std::vector<Vec3> now = places(reference, t);
  const std::vector<Vec3> before = places(reference, t - h), earlier = places(reference, t - 2 * h);
  for (std::size_t i = 0; i < now.size(); ++i) now[i] = (3 * now[i] - 4 * before[i] + earlier[i]) / (2 * h);
  return now;
}

/// Uses a second-order difference of t, t + h and t + 2 h, where h displaces a point by a millionth of the
/// length. A true starting velocity remains with h/10, but decreases for growth from rest as t^a, a > 1.
std::vector<Vec3> PrescribedMotion::starting_velocities(std::span<const Vec3> reference, double t,
                                                        double length) const {
  const std::vector<Vec3> start = places(reference, t);
  std::vector<Vec3> velocities(start.size(), Vec3::Zero());
  const auto forward = [&](std::size_t i, double h) {
    const std::span<const Vec3> one = reference.subspan(i, 1);
    return Vec3((4 * places(one, t + h)[0] - places(one, t + 2 * h)[0] - 3 * start[i]) / (2 * h));
  };
  for (std::size_t i = 0; i < start.size(); ++i) {
    double h = shortest;
    for (const double least = small * length; h < longest; h *= 10)
      if ((places(reference.subspan(i, 1), t + h)[0] - start[i]).norm() > least) break;
    const Vec3 v = forward(i, h), sooner = forward(i, h / 10);
    if (v.norm() > small * small * length / h && (v - sooner).norm() <= 0.3 * v.norm()) velocities[i] = v;
  }
  return velocities;
}

double PrescribedMotion::largest_displacement(std::span<const Vec3> reference, double t) const {
  const std::vector<Vec3> moved = places(reference, t);
  double largest = 0;
  for (std::size_t i = 0; i < moved.size(); ++i)
    largest = std::max(largest, (moved[i] - reference[i]).norm());
  return largest;
}

}  // namespace couplet::fv
