// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/body/body_motion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"

namespace couplet::plate {
namespace {

constexpr int most_body_iterations = 60;
/// Correction of Newton's method relative to the motion of the step, at which it has converged.
constexpr double converged_tolerance = 1e-15;
/// Relative Newton correction below which only round-off is left.
constexpr double stalled_tolerance = 1e-9;
/// Difference of the numerical Jacobian, in units of the body's radius of gyration.
constexpr double jacobian_difference = 1e-6;
/// Largest rotation vector of a body with rotational springs and three free rotations, whose derivative is
/// singular at a full turn [rad].
constexpr double largest_turn = 0.95 * 2 * std::numbers::pi;

Tensor3 skew(const Vec3& v) {
  Tensor3 s;
  s << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return s;
}

/// Gradient T^-T g of a function of the rotation vector with respect to a small rotation about fixed axes,
/// for its derivatives g with respect to the components of the vector.
Vec3 about_fixed_axes(const Vec3& turned, const Vec3& g) {
  const double angle = turned.norm();
  const double half = 0.5 * angle;
  const double c = angle > 1e-4 ? (1 - half / std::tan(half)) / (angle * angle) : 1. / 12;
  const Tensor3 s = skew(turned);
  return g + 0.5 * s * g + c * s * s * g;
}

/// Stiffness, damping or rotation vector of a key that gives three numbers, or one for the only axis.
Vec3 about_axes(const std::vector<double>& given) {
  if (given.empty()) return Vec3::Zero();
  return given.size() == 1 ? Vec3::Constant(given[0]) : Vec3(given.data());
}

}  // namespace

Vec3 BodyLoad::about_reference(const Tensor3& rotation) const {
  const Tensor3 g = rotation * moment;
  return {g(1, 2) - g(2, 1), g(2, 0) - g(0, 2), g(0, 1) - g(1, 0)};
}

BodyMotion::BodyMotion(const BodyParameters& p, const Vec3& gravity)
    : translations_(p.translations()),
      rotations_(p.rotations()),
      mass_(p.mass),
      whole_mass_(p.mass),
      inertia_(p.inertia_tensor()),
      offset_(p.center_of_mass - p.reference()),
      center_(offset_),
      gravity_(gravity),
      initial_spin_(p.initial_angular_velocity) {
  if (translations_.empty()) {  // inertia about the point at rest, by Steiner's theorem
    inertia_ += mass_ * (offset_.squaredNorm() * Tensor3::Identity() - offset_ * offset_.transpose());
    offset_.setZero();
  }
  if (p.springs) {
    stiffness_ = p.springs->translation, rest_ = p.springs->rest_translation;
    turn_stiffness_ = about_axes(p.springs->rotation);
    turn_rest_ = about_axes(p.springs->rest_rotation);
    if (p.springs->rest_rotation.size() == 1) turn_rest_ = p.springs->rest_rotation[0] * rotations_.at(0);
  }
  if (p.dampers) damping_ = p.dampers->translation, turn_damping_ = about_axes(p.dampers->rotation);
  if (p.stops) add_limits(*p.stops);
  if (!rotations_.empty()) length_ = std::sqrt(inertia_.trace() / (3 * mass_));
}

void BodyMotion::add_limits(const Stops& stops) {
  const auto add = [&](const std::optional<Stop>& stop, std::size_t free) {
    if (!stop) return;
    // A linear oscillator with the damping ratio zeta rebounds with exp(-pi zeta / sqrt(1 - zeta^2)) of its
    // speed when it passes its rest position again.
    const double log = std::log(stop->restitution);
    const double zeta = -log / std::sqrt(std::numbers::pi * std::numbers::pi + log * log);
    const double damping = 2 * zeta * std::sqrt(stop->stiffness * inertia(free));
    if (stop->least) limits_.push_back({free, -1, *stop->least, stop->stiffness, damping});
    if (stop->most) limits_.push_back({free, 1, *stop->most, stop->stiffness, damping});
  };
  for (std::size_t i = 0; i < translations_.size(); ++i)
    add(translations_[i].x() > 0 ? stops.x : translations_[i].y() > 0 ? stops.y : stops.z, i);
  if (rotations_.size() == 1) add(stops.rotation, translations_.size());
}

double BodyMotion::inertia(std::size_t i) const {
  if (i < translations_.size()) return mass_;
  const Vec3& axis = rotations_[i - translations_.size()];
  return axis.dot(inertia_ * axis);
}

double BodyMotion::shortest_impact() const {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Limit& limit : limits_)
    shortest = std::min(shortest, std::numbers::pi * std::sqrt(inertia(limit.free) / limit.stiffness));
  return shortest;
}

BodyState BodyMotion::start(const Vec3& velocity) const {
  BodyState state;
  state.spin = initial_spin_;
  if (!translations_.empty()) state.velocity = velocity + initial_spin_.cross(offset_);
  set_energies(state);
  state.energies.initial = state.energies.total();
  return state;
}

Eigen::Vector4d BodyMotion::turned_by(const Eigen::Vector4d& orientation, const Vec3& turn) const {
  const Eigen::Quaterniond by(1, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z());
  return (by * Eigen::Quaterniond(orientation)).normalized().coeffs();
}

/// Rotation vector of an orientation, of all that differ by full turns the one closest to `near`.
Vec3 BodyMotion::rotation_vector(const Eigen::Vector4d& orientation, const Vec3& near) const {
  Vec3 axis = orientation.head<3>();
  double sine = axis.norm();
  if (rotations_.size() == 1)
    axis = rotations_[0], sine = orientation.head<3>().dot(axis);
  else if (sine > 0)
    axis /= sine;
  else
    axis = near.norm() > 0 ? Vec3(near.normalized()) : Vec3(Vec3::UnitZ());
  const double angle = 2 * std::atan2(sine, orientation.w());
  const double turn = 2 * std::numbers::pi;
  return (angle + turn * std::round((axis.dot(near) - angle) / turn)) * axis;
}

BodyMotion::Trial BodyMotion::trial(const BodyState& now, double dt, const Unknown& x) const {
  Trial t;
  t.shift.setZero(), t.turn.setZero();
  Eigen::Index i = 0;
  for (const Vec3& direction : translations_) t.shift += x[i++] * direction;
  for (const Vec3& axis : rotations_) t.turn += x[i++] * axis;
  const Tensor3 before = now.rotation();
  const Eigen::Vector4d orientation = turned_by(now.orientation, t.turn);
  t.rotation = Eigen::Quaterniond(orientation).toRotationMatrix();
  t.mean = 0.5 * (before + t.rotation);
  t.turned = rotation_vector(orientation, now.turned + t.turn);
  t.spin = 2 / dt * (before.transpose() * t.turn) - now.spin;
  t.arm = t.mean * offset_;
  t.velocity.setZero();
  if (!translations_.empty()) t.velocity = 2 / dt * (t.shift + t.turn.cross(t.arm)) - now.velocity;
  return t;
}

/// Mean moment of the rotational springs over a step, whose work is the loss of their energy V [gonzalez2000]:
/// -(grad V + ((V1 - V0 - grad V . theta) / theta^2) theta) with the gradient at the middle.
Vec3 BodyMotion::spring_moment(const Vec3& before, const Vec3& after, const Vec3& turn) const {
  const Vec3 middle = 0.5 * (before + after);
  const Vec3 g = turn_stiffness_.cwiseProduct(middle - turn_rest_);
  Vec3 moment =
      rotations_.size() == 1 ? Vec3(g.dot(rotations_[0]) * rotations_[0]) : about_fixed_axes(middle, g);
  const double square = turn.squaredNorm();
  if (square > 1e-24) moment += (g.dot(after - before) - moment.dot(turn)) / square * turn;
  return -moment;
}

/// Residuals of all free degrees of freedom without the stops, [N] and [N m].
void BodyMotion::set_smooth(const BodyState& now, double dt, const BodyLoad& load, const Trial& t,
                            Unknown& residual) const {
  Eigen::Index i = 0;
  const Vec3 inertia = mass_ / dt * (t.velocity - now.velocity);
  if (!translations_.empty()) {
    const Vec3 force = load.force + whole_mass_ * gravity_ -
                       stiffness_.cwiseProduct(now.translation + 0.5 * t.shift - rest_) -
                       damping_.cwiseProduct(t.shift) / dt;
    for (const Vec3& direction : translations_) residual[i++] = direction.dot(inertia - force);
  }
  if (rotations_.empty()) return;
  Vec3 moment = load.about_reference(t.mean) + (t.mean * center_).cross(whole_mass_ * gravity_) -
                turn_damping_.cwiseProduct(t.turn) / dt;
  if (!turn_stiffness_.isZero(0)) moment += spring_moment(now.turned, t.turned, t.turn);
  Vec3 change = (t.rotation * (inertia_ * t.spin) - now.rotation() * (inertia_ * now.spin)) / dt;
  if (!translations_.empty()) change += t.arm.cross(inertia);
  for (const Vec3& axis : rotations_) residual[i++] = axis.dot(change - moment);
}

double BodyMotion::coordinate(const Limit& limit, const Vec3& translation, const Vec3& turned) const {
  return limit.free < translations_.size() ? translations_[limit.free].dot(translation)
                                           : rotations_[0].dot(turned);
}

/// Adds the forces of the stops, whose spring has the mean force of the step [gonzalez2000] and whose damper resists the change of the
/// penetration, and their derivatives.
void BodyMotion::add_stops(const BodyState& now, double dt, const Trial& t, const Unknown& x,
                           Unknown& residual, Jacobian* tangent) const {
  for (const Limit& limit : limits_) {
    const auto i = Eigen::Index(limit.free);
    const double before = limit.sign * (coordinate(limit, now.translation, now.turned) - limit.place);
    const double after = limit.sign * (coordinate(limit, now.translation + t.shift, t.turned) - limit.place);
    if (!(before > 0 || after > 0)) continue;
    const contact::ContactForce spring = contact::push(before, after);
    const double force =
        limit.stiffness * spring.force + limit.damping / dt * (std::max(after, 0.) - std::max(before, 0.));
    const double slope = limit.stiffness * spring.slope + (after > 0 ? limit.damping / dt : 0.);
    // The angle of a step is 2 atan(theta / 2); the ratio makes the work of the moment that of the angle.
    double ratio = 1, d_angle = 1, d_ratio = 0;
    if (limit.free >= translations_.size()) {
      const double theta = x[i];
      d_angle = 1 / (1 + 0.25 * theta * theta);
      if (std::abs(theta) > 1e-4) {
        ratio = 2 * std::atan(0.5 * theta) / theta;
        d_ratio = (d_angle - ratio) / theta;
      } else {
        ratio = 1 - theta * theta / 12, d_ratio = -theta / 6;
      }
    }
    residual[i] += limit.sign * force * ratio;
    if (tangent) (*tangent)(i, i) += slope * d_angle * ratio + limit.sign * force * d_ratio;
  }
}

void BodyMotion::step(const BodyState& now, double dt, const BodyLoad& load, BodyState& next) {
  const auto n = Eigen::Index(n_free());
  const auto n_along = Eigen::Index(translations_.size());
  Unknown x(n), residual(n), plus(n), minus(n), correction(n), unit(n);
  Jacobian jacobian(n, n);
  const Vec3 omega = now.angular_velocity(), speed = reference_velocity(now);
  double scale = 0;
  const double accelerated =
      0.5 * dt * dt / mass_ *
      (load.force.norm() + whole_mass_ * gravity_.norm() + load.moment.norm() / length_);
  for (Eigen::Index i = 0; i < n; ++i) {
    unit[i] = i < n_along ? length_ : 1;  // length_ makes a rotation of 1 rad comparable
    x[i] = dt * (i < n_along ? translations_[std::size_t(i)].dot(speed)
                             : rotations_[std::size_t(i - n_along)].dot(omega));
  }
  scale = (dt * speed.norm() + now.translation.norm() + rest_.norm() + accelerated) / length_ +
          dt * omega.norm() + now.turned.norm() + turn_rest_.norm();
  const auto evaluate = [&](Unknown& r, const Unknown& at, Jacobian* tangent) {
    const Trial t = trial(now, dt, at);
    set_smooth(now, dt, load, t, r);
    if (!limits_.empty()) add_stops(now, dt, t, at, r, tangent);
    return r.cwiseProduct(unit).norm();
  };
  double size = evaluate(residual, x, nullptr), last = std::numeric_limits<double>::infinity();
  for (iterations_ = 0; size != 0; ++iterations_) {  // also for a residual that is not a number
    if (iterations_ == most_body_iterations || !std::isfinite(size))
      throw SolveFailure(
          "The motion of the rigid body did not converge in {} iterations of Newton's method (residual {:.2e} N m). Use a smaller "
          "'simulation.time-step'.",
          iterations_, size);
    for (Eigen::Index j = 0; j < n; ++j) {
      Unknown moved = x;
      moved[j] = x[j] + jacobian_difference * unit[j];
      set_smooth(now, dt, load, trial(now, dt, moved), plus);
      moved[j] = x[j] - jacobian_difference * unit[j];
      set_smooth(now, dt, load, trial(now, dt, moved), minus);
      jacobian.col(j) = (plus - minus) / (2 * jacobian_difference * unit[j]);
    }
    if (!limits_.empty()) {
      Unknown unused = residual;
      add_stops(now, dt, trial(now, dt, x), x, unused, &jacobian);
    }
    correction = jacobian.partialPivLu().solve(residual);
    const double step = correction.cwiseQuotient(unit).norm(), before = size;
    x -= correction;
    size = evaluate(residual, x, nullptr);
    double part = 1;
    while (!limits_.empty() && size > before && part > 1e-3) {
      x += 0.5 * part * correction;
      part *= 0.5;
      size = evaluate(residual, x, nullptr);
    }
    if (step <= converged_tolerance * scale) break;
    if (step >= 0.5 * last && step <= stalled_tolerance * scale) break;
    last = step;
  }
  const Trial t = trial(now, dt, x);
  next.translation = now.translation + t.shift;
  next.orientation = turned_by(now.orientation, t.turn);
  next.turned = t.turned;
  next.velocity = t.velocity;
  next.spin = t.spin;
  next.dt = dt;
  if (!turn_stiffness_.isZero(0) && rotations_.size() == 3 && next.turned.norm() > largest_turn)
    throw SolveFailure(
        "The rigid body has turned by {:.4g} degrees: springs about three axes are defined up to {:.4g} degrees.",
        next.turned.norm() * 180 / std::numbers::pi, largest_turn * 180 / std::numbers::pi);
  add_work(now, dt, load, t, next);
}

void BodyMotion::add_work(const BodyState& now, double dt, const BodyLoad& load, const Trial& t,
                          BodyState& next) const {
  next.energies = now.energies;
  Energies& e = next.energies;
  e.load_work += load.force.dot(t.shift) + load.about_reference(t.mean).dot(t.turn);
  e.damping_loss +=
      (damping_.cwiseProduct(t.shift).dot(t.shift) + turn_damping_.cwiseProduct(t.turn).dot(t.turn)) / dt;
  const double held = now.energies.contact;
  for (const Limit& limit : limits_) {
    const double from = coordinate(limit, now.translation, now.turned),
                 to = coordinate(limit, next.translation, next.turned);
    const double before = limit.sign * (from - limit.place), after = limit.sign * (to - limit.place);
    if (!(before > 0 || after > 0)) continue;
    e.damping_loss += limit.damping / dt * (std::max(after, 0.) - std::max(before, 0.)) * (after - before);
    e.impact_work -= limit.damping / dt * (std::max(after, 0.) - std::max(before, 0.)) * (after - before);
  }
  set_energies(next);
  e.impact_work -= e.contact - held;
}

void BodyMotion::set_energies(BodyState& state) const {
  Energies& e = state.energies;
  e.kinetic = 0.5 * mass_ * state.velocity.squaredNorm() + 0.5 * state.spin.dot(inertia_ * state.spin);
  const Vec3 stretch = state.translation - rest_, twist = state.turned - turn_rest_;
  e.strain =
      0.5 * (stiffness_.cwiseProduct(stretch).dot(stretch) + turn_stiffness_.cwiseProduct(twist).dot(twist));
  e.gravity = -whole_mass_ * gravity_.dot(displacement(state, center_));
  e.contact = 0;
  for (const Limit& limit : limits_) {
    const double depth =
        std::max(0., limit.sign * (coordinate(limit, state.translation, state.turned) - limit.place));
    e.contact += 0.5 * limit.stiffness * depth * depth;
  }
}

Vec3 BodyMotion::displacement(const BodyState& state, const Vec3& arm) const {
  return state.translation + (state.rotation() * arm - arm);
}

Vec3 BodyMotion::reference_velocity(const BodyState& state) const {
  if (translations_.empty()) return Vec3::Zero();
  const Vec3 all = state.velocity - state.angular_velocity().cross(state.rotation() * offset_);
  Vec3 free = Vec3::Zero();
  for (const Vec3& direction : translations_) free += direction.dot(all) * direction;
  return free;
}

Vec3 BodyMotion::velocity(const BodyState& state, const Vec3& arm) const {
  return reference_velocity(state) + state.angular_velocity().cross(state.rotation() * arm);
}

Vec3 BodyMotion::angular_momentum(const BodyState& state) const {
  return state.rotation() * (inertia_ * state.spin);
}

std::vector<double> BodyMotion::weighted_velocity(const BodyState& state) const {
  const Vec3 speed = reference_velocity(state), omega = state.angular_velocity();
  std::vector<double> all;
  for (std::size_t i = 0; i < n_free(); ++i)
    all.push_back(std::sqrt(inertia(i)) * (i < translations_.size()
                                               ? translations_[i].dot(speed)
                                               : rotations_[i - translations_.size()].dot(omega)));
  return all;
}

}  // namespace couplet::plate
