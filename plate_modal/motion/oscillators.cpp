// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/motion/oscillators.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"

namespace couplet::plate {
namespace {

constexpr int most_iterations = 60;
/// Tolerance of the residual relative to its terms, near round-off.
constexpr double newton_tolerance = 1e-13;

}  // namespace

Oscillators::Oscillators(std::vector<double> omega, std::vector<double> damping, std::vector<double> gravity,
                         time::TimeSchemeParameters scheme, const Contact* contact)
    : omega_(std::move(omega)),
      damping_(std::move(damping)),
      gravity_(std::move(gravity)),
      scheme_(scheme),
      contact_(contact),
      load_(omega_.size()),
      diagonal_(load_),
      rhs_(load_),
      x_(load_) {
  if (!contact_) return;
  shown_ = load_;
  const auto n = Eigen::Index(omega_.size());
  residual_.resize(n);
  correction_.resize(n);
  jacobian_.resize(n, n);
}

ModalState Oscillators::start(std::vector<double> q, std::vector<double> v) const {
  ModalState state;
  state.q = std::move(q);
  state.v = std::move(v);
  if (time::uses_acceleration(scheme_.type)) state.a.assign(state.q.size(), 0);
  if (time::uses_old_level(scheme_.type)) state.q_old = state.v_old = state.q;
  Contact::ContactResult seat;
  if (contact_) contact_->find(state.q, seat);
  Energies& e = state.energies;
  for (std::size_t m = 0; m < omega_.size(); ++m) {
    e.kinetic += 0.5 * state.v[m] * state.v[m];
    e.strain += 0.5 * omega_[m] * omega_[m] * state.q[m] * state.q[m];
    e.gravity -= gravity_[m] * state.q[m];
  }
  e.contact = seat.energy;
  e.initial = e.total();
  return state;
}

/// Part of a linear combination that does not depend on the unknown.
double Oscillators::known(const time::Levels& l, const ModalState& at, std::size_t m) const {
  double value = l.u * at.q[m] + l.v * at.v[m];
  if (!at.a.empty()) value += l.a * at.a[m];
  if (!at.q_old.empty()) value += l.u_old * at.q_old[m] + l.v_old * at.v_old[m];
  return value;
}

void Oscillators::step(const ModalState& now, double dt, const LoadAt& load, ModalState& next) {
  const std::vector<time::Stage> stages =
      time::second_order_stages(scheme_, dt, {now.dt > 0 ? 1 : 0, now.dt});
  iterations_ = 0;
  work_ = now;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const time::Stage& stage = stages[i];
    load(stage.start + stage.place * stage.dt, load_);
    advance(stage, work_, next);
    add_energies(stage, work_, next);
    if (i + 1 == stages.size()) break;
    // The second stage of a Bathe step uses the first as its old level.
    next.q_old = work_.q, next.v_old = work_.v;
    std::swap(work_, next);
  }
  if (time::uses_old_level(scheme_.type)) {
    next.q_old = now.q, next.v_old = now.v;
  } else {
    next.q_old.clear(), next.v_old.clear();
  }
  next.dt = dt;
  finish(next);
}

/// One stage of all modes: acceleration + c rate + omega^2 x = load, each a combination of levels of x.
void Oscillators::advance(const time::Stage& stage, const ModalState& at, ModalState& next) {
  const std::size_t n = omega_.size();
  for (std::size_t m = 0; m < n; ++m) {
    diagonal_[m] = stage.acceleration.x + damping_[m] * stage.rate.x + omega_[m] * omega_[m];
    rhs_[m] =
        load_[m] + gravity_[m] - known(stage.acceleration, at, m) - damping_[m] * known(stage.rate, at, m);
    x_[m] = rhs_[m] / diagonal_[m];
  }
  if (contact_) solve_contact(stage, at);
  next.q.resize(n), next.v.resize(n), next.a.resize(at.a.size());
  for (std::size_t m = 0; m < n; ++m) {
    next.q[m] = stage.end_value.x * x_[m] + known(stage.end_value, at, m);
    next.v[m] = stage.end_rate.x * x_[m] + known(stage.end_rate, at, m);
    if (!at.a.empty()) next.a[m] = stage.end_acceleration.x * x_[m] + known(stage.end_acceleration, at, m);
  }
  next.energies = at.energies;
}

/// Newton's method for diagonal x - rhs - impact(x) = 0. The impact derives from a convex energy, so some
/// step along the correction always reduces the residual.
void Oscillators::solve_contact(const time::Stage& stage, const ModalState& at) {
  const std::size_t n = omega_.size();
  const time::Levels shown = scheme_.type == time::TimeScheme::trapezoidal && contact_->is_conserving()
                                 ? stage.end_value
                                 : time::Levels{1, 0, 0, 0, 0, 0};
  double scale = 0;
  const auto evaluate = [&] {
    for (std::size_t m = 0; m < n; ++m) shown_[m] = shown.x * x_[m] + known(shown, at, m);
    contact_->evaluate(at.q, shown_, seat_);
    scale = 0;
    for (std::size_t m = 0; m < n; ++m) {
      residual_[m] = diagonal_[m] * x_[m] - rhs_[m] - seat_.force[m];
      scale = std::max({scale, std::abs(diagonal_[m] * x_[m]), std::abs(rhs_[m]), std::abs(seat_.force[m])});
    }
    return residual_.norm();
  };
  double size = evaluate();
  for (int i = 0; size > newton_tolerance * scale; ++i) {
    if (i == most_iterations)
      throw SolveFailure(
          "The impact on the seat did not converge in {} iterations of Newton's method (residual {:.2e} of "
          "{:.2e}).",
          most_iterations, size, scale);
    jacobian_ = shown.x * seat_.tangent;
    for (std::size_t m = 0; m < n; ++m) jacobian_(m, m) += diagonal_[m];
    correction_ = jacobian_.llt().solve(residual_);
    const double before = size;
    double part = 1;
    for (std::size_t m = 0; m < n; ++m) x_[m] -= correction_[m];
    for (size = evaluate(); size > before && part > 1e-3; size = evaluate()) {
      for (std::size_t m = 0; m < n; ++m) x_[m] += 0.5 * part * correction_[m];
      part *= 0.5;
    }
    iterations_ = std::max(iterations_, i + 1);
    // Newton's method has stalled at round-off.
    if (size >= before && size <= 1e3 * newton_tolerance * scale) break;
  }
}

void Oscillators::add_energies(const time::Stage& stage, const ModalState& at, ModalState& next) {
  Energies& e = next.energies;
  for (std::size_t m = 0; m < omega_.size(); ++m) {
    const double moved = next.q[m] - at.q[m];
    e.load_work += load_[m] * moved;
    if (contact_) e.impact_work += seat_.force[m] * moved;
    e.damping_loss += damping_[m] * moved * moved / stage.dt;
  }
}

void Oscillators::finish(ModalState& state) {
  Energies& e = state.energies;
  e.kinetic = e.strain = e.gravity = 0;
  for (std::size_t m = 0; m < omega_.size(); ++m) {
    e.kinetic += 0.5 * state.v[m] * state.v[m];
    e.strain += 0.5 * omega_[m] * omega_[m] * state.q[m] * state.q[m];
    e.gravity -= gravity_[m] * state.q[m];
  }
  if (!contact_) return;
  contact_->find(state.q, seat_);
  e.contact = seat_.energy;
}

}  // namespace couplet::plate
