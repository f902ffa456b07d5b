// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/prescribed_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace couplet::fluid {
namespace {

// Of the step, for the difference quotient: its error is 1e-6 of a second order scheme's.
constexpr double backwards = 1e-3;

std::vector<Expression> expressions(const std::vector<config::ExpressionText>& texts, int dim,
                                    const char* where) {
  return texts.empty() ? std::vector<Expression>{} : make_expressions(texts, dim, where);
}

}  // namespace

PrescribedMotion::PrescribedMotion(const MotionParameters& parameters, int dim)
    : parameters_(parameters),
      translation_(expressions(parameters.translation, dim, "motion.translation")),
      displacement_(expressions(parameters.displacement, dim, "motion.displacement")),
      angle_(parameters.angle, "motion.angle") {}

/// 1 - 10 q^3 + 15 q^4 - 6 q^5 between the radii: no kink at either.
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
    if (s == 0) continue;
    Vec3 shift = translation;
    if (!field.empty()) shift += field[i];
    if (angle != 0) moved[i] = centre + Eigen::AngleAxisd(s * angle, axis) * (reference[i] - centre);
    moved[i] += s * shift;
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

double PrescribedMotion::largest_displacement(std::span<const Vec3> reference, double t) const {
  const std::vector<Vec3> moved = places(reference, t);
  double largest = 0;
  for (std::size_t i = 0; i < moved.size(); ++i)
    largest = std::max(largest, (moved[i] - reference[i]).norm());
  return largest;
}

}  // namespace couplet::fluid
