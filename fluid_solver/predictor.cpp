// SPDX-License-Identifier: Apache-2.0
// The predictor of FractionalStep: everything before the pressure equation.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/fractional_step.hpp"

namespace couplet::fluid {
namespace {

// Modified Crank-Nicolson a L u^{n+1} + b L u^n + c L u^{n-1}: second order for any step ratio, and it damps
// stiff modes.
constexpr double c_modified = 1.0 / 16;
constexpr int most_passes = 60;
// Up to here two passes of the pressure equation hold after an implicit predictor (measured: 40 hold, 50
// grow).
constexpr double largest_degrees = 40;

}  // namespace

template <int D>
void FractionalStep<D>::predict(const State<D>& from, const History<D>& by, SubStep<D> step,
                                const Vectors<D>& w) {
  step_ = std::move(step);
  by_ = by;
  level_.reset();
  w_ = w;
  const bool moving = !step_.swept.empty();
  const bool implicit = by_.implicit;
  if (moving)
    for (std::size_t b = 0; b < w_.size(); ++b)
      if (boundary_.kind()[b] == FaceKind::slip) {
        const Index f = mesh_.n_interior + static_cast<Index>(b);
        w_[b] = step_.swept[f] / (step_.dt * step_.to->area[f].squaredNorm()) * step_.to->area[f];
      }
  if (bodies_) mark_bodies(by_.time + step_.dt);
  const double dt = step_.dt, ratio = by_.dt_old > 0 ? dt / by_.dt_old : 0;
  const double e0 = 1 + ratio / 2, e1 = -ratio / 2;

  const bool given = !step_.rate.empty();
  if (!given) set_rates(from, implicit);
  right_side_.resize(from.u.size());
  const std::vector<double>& volume = from.placement->volume;
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    right_side_[c] = volume[c] * from.u[c] + (given ? dt * step_.rate[c] : dt * e0 * rates_.rate[c]);
  if (ratio > 0 && !given)
    for (Index c = 0; c < mesh_.cells.n_local(); ++c) right_side_[c] += dt * e1 * from.rates_old.rate[c];
  if (!body_force_.empty()) add_body_force();
  if (moving) add_swept(from, e0, e1);
  if (moving || implicit) add_old_pressure(from, implicit);
  u_p_.resize(from.u.size());
  viscous_force_.resize(w_.size());
  if (implicit) {
    const double c = ratio > 0 ? c_modified : 0, a = ratio > 0 ? 0.5 + c / ratio : 1, b = 1 - a - c;
    for (Index i = 0; i < mesh_.cells.n_owned(); ++i) right_side_[i] += dt * b * rates_.viscous[i];
    if (ratio > 0)
      for (Index i = 0; i < mesh_.cells.n_owned(); ++i) right_side_[i] += dt * c * from.rates_old.viscous[i];
    solve_viscous(from, w_, a);
  } else {
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) u_p_[c] = right_side_[c] / step_.to->volume[c];
    if (given) viscous_force_ = step_.shear;
    for (std::size_t b = 0; b < shear_.size() && !given; ++b)
      viscous_force_[b] = ratio > 0 ? Vec<D>(e0 * shear_[b] + e1 * from.shear_old[b]) : shear_[b];
  }
  remember_prediction(implicit);
  mesh_.cells.update_ghosts(flat<D>(u_p_), D);
  if (bodies_) bodies_->force(*step_.to, u_p_);
  extrapolate_pressure();
  predict_flux(from);
  if (assembled_ != step_.to) {
    if (oblique_) set_obliqueness(*step_.to);
    pressure_.set(pressure_placement());
    assembled_ = step_.to;
  }
}

template <int D>
void FractionalStep<D>::set_obliqueness(const Placement<D>& at) {
  degrees_ = std::atan(max(mesh_.comm, at.obliqueness)) * 180 / std::numbers::pi;
  very_oblique_ = degrees_ > largest_degrees;
}

template <int D>
void FractionalStep<D>::set_rates(const State<D>& from, bool implicit) {
  const bool at_hand = gradient_of_ != 0 && gradient_of_ == from.number;
  rate_operator_.apply(from, implicit, oblique_, rates_, at_hand ? &velocity_gradient_ : nullptr);
  wall_shear<D>(mesh_, *from.placement, parameters_.viscosity, from.u, from.u_boundary, shear_);
  if (bodies_)
    for (Index c = 0; c < mesh_.cells.n_local(); ++c)
      if (bodies_->is_solid(c)) rates_.rate[c].setZero();
}

template <int D>
void FractionalStep<D>::rates(const State<D>& of, Vectors<D>& rate, Vectors<D>& shear) {
  set_rates(of, false);
  rate = rates_.rate;
  shear = shear_;
}

// Volume-integrated at t^{n+1/2}, where the pressure lives that may balance it.
template <int D>
void FractionalStep<D>::add_body_force() {
  std::vector<Vec3> places(mesh_.cells.n_local(), Vec3::Zero());
  for (std::size_t c = 0; c < places.size(); ++c) places[c].template head<D>() = step_.to->centre[c];
  force_.resize(places.size());
  for (int c = 0; c < D; ++c) body_force_[c].evaluate(places, by_.time + step_.dt / 2, flat<D>(force_), D, c);
  for (std::size_t c = 0; c < places.size(); ++c)
    right_side_[c] += step_.dt * step_.to->volume[c] * force_[c];
}

// sum dV_f u~_f with u~ extrapolated to n+1/2: with the rates of a mesh held still this is the "split" ALE
// form, second order in time and exact for a uniform flow.
template <int D>
void FractionalStep<D>::add_swept(const State<D>& from, double e0, double e1) {
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    Vec<D> value = 0.5 * e0 * (from.u[p] + from.u[n]);
    if (e1 != 0) value += 0.5 * e1 * (from.u_old[p] + from.u_old[n]);
    right_side_[p] += step_.swept[f] * value;
    right_side_[n] -= step_.swept[f] * value;
  }
  for (std::size_t b = 0; b < from.u_boundary.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    Vec<D> value = e0 * from.u_boundary[b];
    if (e1 != 0) value += e1 * from.u_boundary_old[b];
    right_side_[mesh_.owner[f]] += step_.swept[f] * value;
  }
}

// Explicit viscous term: -(dt/rho) sum p_f^{n-1/2} (S^{n+1/2} - S^{n+1}), which makes the pressure force
// second order in time on a moving mesh. Implicit: -(dt/rho) sum p_f^{n-1/2} S^{n+1/2}, so that the wall
// velocity is the right boundary value of the predictor; add_back_old_pressure() returns the part on S^{n+1}.
template <int D>
void FractionalStep<D>::add_old_pressure(const State<D>& from, bool implicit) {
  if (!by_.pressure[0]) return;
  const PressureLevel<D>& level = *by_.pressure[0];
  const double factor = step_.dt / rho_;
  const Placement<D>&old = *from.placement, &now = *step_.to;
  if (step_.swept.empty()) {  // S does not change: the gradient of that step is still at hand
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      right_side_[c] -= factor * now.volume[c] * level.gradient[c];
    return;
  }
  if (implicit) old_pressure_.assign(right_side_.size(), Vec<D>::Zero());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    double value = now.weight[f] * level.p[p] + (1 - now.weight[f]) * level.p[n];
    if (now.skewed()) value += skew_part(now, level.gradient, f);
    const Vec<D> part = factor * value * 0.5 * (old.area[f] - now.area[f]);
    right_side_[p] -= part;
    right_side_[n] += part;
    if (!implicit) continue;
    const Vec<D> back = factor * value * now.area[f];
    old_pressure_[p] += back;
    old_pressure_[n] -= back;
  }
  for (std::size_t b = 0; b < level.boundary.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
    right_side_[p] -= factor * level.boundary[b] * 0.5 * (old.area[f] - now.area[f]);
    if (implicit) old_pressure_[p] += factor * level.boundary[b] * now.area[f];
  }
  if (!implicit) return;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) right_side_[c] -= old_pressure_[c];
}

/// What is left of the residual adds up over the steps: much tighter than the change of u in one of them.
template <int D>
double FractionalStep<D>::viscous_tolerance() const {
  return std::min(1e-7, 0.1 * parameters_.pressure_tolerance);
}

/// u^n + r (u^n - u^{n-1}), then one sweep of Jacobi's method, which costs no face loop: its viscous rate is
/// that of the levels, extrapolated in the same way.
template <int D>
void FractionalStep<D>::guess_velocity(const State<D>& from, double a) {
  if (by_.dt_old == 0) {
    u_p_ = from.u;
    return;
  }
  const double ratio = step_.dt / by_.dt_old;
  const std::vector<double>& inverse = viscous_solver_.inverse_diagonal();
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const Vec<D> ahead = from.u[c] + ratio * (from.u[c] - from.u_old[c]);
    const Vec<D> rate = rates_.viscous[c] + ratio * (rates_.viscous[c] - from.rates_old.viscous[c]);
    u_p_[c] = ahead + inverse[c] * (right_side_[c] + step_.dt * a * rate - step_.to->volume[c] * ahead);
  }
  mesh_.cells.update_ghosts(flat<D>(u_p_), D);
}

template <int D>
void FractionalStep<D>::solve_viscous(const State<D>& from, const Vectors<D>& w, double a) {
  viscous_solver_.prepare(*step_.to, a * nu_ * step_.dt);
  guess_velocity(from, a);
  if (oblique_)
    solve_oblique_viscous(w, a);
  else
    statistics_.viscous_iterations += viscous_solver_.solve(w, viscous_tolerance(), right_side_, u_p_);
  boundary_.close(mesh_, *step_.to, u_p_, w, u_boundary_);
  wall_shear<D>(mesh_, *step_.to, parameters_.viscosity, u_p_, u_boundary_, viscous_force_);
  for (std::size_t b = 0; b < shear_.size(); ++b) viscous_force_[b] = 0.5 * (viscous_force_[b] + shear_[b]);
  add_back_old_pressure();
}

/// The non-orthogonal part is implicit too, by passes of deferred correction: left explicit beside an
/// implicit orthogonal part it grows as soon as its share of the operator exceeds 1/8 (AB2 against 9/16, 3/8,
/// 1/16), which a mesh sheared by 14 degrees reaches. The passes contract by that share.
template <int D>
void FractionalStep<D>::solve_oblique_viscous(const Vectors<D>& w, double a) {
  const double enough = std::clamp(10 * parameters_.pressure_tolerance, 1e-11, 1e-4);
  for (int pass = 1;; ++pass) {
    boundary_.close(mesh_, *step_.to, u_p_, w, u_boundary_);
    oblique_rate_.assign(u_p_.size(), Vec<D>::Zero());
    rate_operator_.add_oblique(*step_.to, u_p_, u_boundary_, oblique_rate_);
    viscous_side_ = right_side_;
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) viscous_side_[c] += step_.dt * a * oblique_rate_[c];
    u_before_ = u_p_;
    statistics_.viscous_iterations += viscous_solver_.solve(w, viscous_tolerance(), viscous_side_, u_p_);
    double sums[2] = {0, 0};
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
      sums[0] += (u_p_[c] - u_before_[c]).squaredNorm();
      sums[1] += u_p_[c].squaredNorm();
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    if (sums[0] <= enough * enough * sums[1]) return;
    if (pass == most_passes)
      throw SolveFailure(
          "The non-orthogonal part of the viscous term did not converge in {} passes (change {:.2e}). The "
          "mesh is "
          "too oblique for an implicit viscous term: use 'viscous: explicit'.",
          most_passes, std::sqrt(sums[0] / sums[1]));
  }
}

template <int D>
void FractionalStep<D>::add_back_old_pressure() {
  if (!by_.pressure[0]) return;
  const PressureLevel<D>& level = *by_.pressure[0];
  const double factor = step_.dt / rho_;
  if (step_.swept.empty()) {
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) u_p_[c] += factor * level.gradient[c];
    return;
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) u_p_[c] += old_pressure_[c] / step_.to->volume[c];
}

/// p~ at t^{n+1/2}, the guess of the pressure equation, through the levels at hand (three only where the
/// solver's noise is small), and the gradient to start the non-orthogonal part with, linear in time through
/// the last two. With q < 1 its share of the operator, two passes make that z^2 = q^2 (2 z - 1), |z| = q: no
/// step amplifies it. A parabola would need q < 0.7, a single pass q < 1/3.
template <int D>
void FractionalStep<D>::extrapolate_pressure() {
  const std::size_t order = parameters_.pressure_tolerance >= 1e-3 ? 2 : 3;
  const double t = by_.time + step_.dt / 2;
  std::vector<const PressureLevel<D>*> levels;
  for (std::size_t k = 0; k < order && by_.pressure[k]; ++k) levels.push_back(by_.pressure[k].get());
  std::array<double, 3> weight{1, 1, 1};
  for (std::size_t k = 0; k < levels.size(); ++k)
    for (std::size_t j = 0; j < levels.size(); ++j)
      if (j != k) weight[k] *= (t - levels[j]->time) / (levels[k]->time - levels[j]->time);
  if (levels.size() == 3) {
    p_.resize(mesh_.cells.n_local());
    for (std::size_t c = 0; c < p_.size(); ++c)
      p_[c] = weight[0] * levels[0]->p[c] + weight[1] * levels[1]->p[c] + weight[2] * levels[2]->p[c];
  } else {
    p_.assign(mesh_.cells.n_local(), 0.0);
    for (std::size_t k = 0; k < levels.size(); ++k)
      for (std::size_t c = 0; c < p_.size(); ++c) p_[c] += weight[k] * levels[k]->p[c];
  }
  gradient_start_.clear();
  if (!oblique_ || levels.empty()) return;
  gradient_start_ = levels[0]->gradient;
  if (levels.size() < 2 || levels[1]->gradient.empty()) return;
  const double ahead = (t - levels[0]->time) / (levels[0]->time - levels[1]->time);
  for (std::size_t c = 0; c < gradient_start_.size(); ++c)
    gradient_start_[c] += ahead * (levels[0]->gradient[c] - levels[1]->gradient[c]);
}

template void FractionalStep<2>::predict(const State<2>&, const History<2>&, SubStep<2>, const Vectors<2>&);
template void FractionalStep<3>::predict(const State<3>&, const History<3>&, SubStep<3>, const Vectors<3>&);
template void FractionalStep<2>::set_obliqueness(const Placement<2>&);
template void FractionalStep<3>::set_obliqueness(const Placement<3>&);
template void FractionalStep<2>::rates(const State<2>&, Vectors<2>&, Vectors<2>&);
template void FractionalStep<3>::rates(const State<3>&, Vectors<3>&, Vectors<3>&);

}  // namespace couplet::fluid
