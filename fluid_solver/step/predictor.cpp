// SPDX-License-Identifier: Apache-2.0
// Everything before the face fluxes and the pressure equation.
#include "fluid_solver/step/predictor.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"

namespace couplet::fluid {
namespace {

// Modified Crank-Nicolson a L u^{n+1} + b L u^n + c L u^{n-1}: second order for any step ratio, and it damps
// stiff modes.
constexpr double c_modified = 1.0 / 16;

/// u + (a R + b R_old)/V, what an explicit step on a mesh at rest without forces comes to; R_old null: without.
template <int D>
[[gnu::always_inline]] inline void go_explicitly(std::span<const double> volume, const Vectors<D>& u,
                                                 double a, const Vec<D>* rate, double b, const Vec<D>* old,
                                                 Vectors<D>& to) {
  const Vec<D>* from = u.data();
  Vec<D>* result = to.data();
  for (std::size_t c = 0; c < volume.size(); ++c) {
    const double per_volume = 1 / volume[c], now = a * per_volume, before = b * per_volume;
    if (old)
      result[c] = from[c] + now * rate[c] + before * old[c];
    else
      result[c] = from[c] + now * rate[c];
  }
}
COUPLET_PROCESSOR_CLONES void explicit_pass(std::span<const double> volume, const Vectors<2>& u, double a,
                                            const Vec<2>* rate, double b, const Vec<2>* old, Vectors<2>& to) {
  go_explicitly<2>(volume, u, a, rate, b, old, to);
}
COUPLET_PROCESSOR_CLONES void explicit_pass(std::span<const double> volume, const Vectors<3>& u, double a,
                                            const Vec<3>* rate, double b, const Vec<3>* old, Vectors<3>& to) {
  go_explicitly<3>(volume, u, a, rate, b, old, to);
}

}  // namespace

template <int D>
Predictor<D>::Predictor(StepWork<D>& work)
    : k_(work),
      rate_operator_(work.mesh, work.boundary, work.nu, work.sound > 0),
      friction_(work, rate_operator_) {
  if (!work.parameters.body_force.empty())
    body_force_ = fv::make_expressions(work.parameters.body_force, D, "body-force");
}

template <int D>
void Predictor<D>::predict(const State<D>& from) {
  const bool moving = !k_.step.swept.empty(), implicit = k_.by.implicit;
  const double dt = k_.step.dt, ratio = k_.by.dt_old > 0 ? dt / k_.by.dt_old : 0;
  const double e0 = 1 + ratio / 2, e1 = -ratio / 2;

  const bool given = !k_.step.rate.empty();
  if (!given) set_rates(from, implicit);
  k_.right_side.resize(from.u.size());
  k_.u_p.resize(from.u.size());
  k_.viscous_flux.resize(k_.w.size());
  const bool forced = !body_force_.empty() || k_.frame;
  if (!moving && !implicit && !given && !forced) {
    explicit_pass(std::span(from.placement->volume).first(k_.mesh.cells.n_owned()), from.u, dt * e0,
                  rates_.rate.data(), dt * e1, ratio > 0 ? from.rates_old.rate.data() : nullptr, k_.u_p);
    return set_explicit_friction(from, e0, e1);
  }
  const std::vector<double>& volume = from.placement->volume;
  for (Index c = 0; c < k_.mesh.cells.n_local(); ++c)
    k_.right_side[c] = volume[c] * from.u[c] + (given ? dt * k_.step.rate[c] : dt * e0 * rates_.rate[c]);
  if (ratio > 0 && !given)
    for (Index c = 0; c < k_.mesh.cells.n_local(); ++c) k_.right_side[c] += dt * e1 * from.rates_old.rate[c];
  if (forced) add_body_force(from, e0, e1);
  if (moving) add_swept(from, e0, e1);
  if (moving || implicit) add_old_pressure(from, implicit);
  if (implicit) {
    const double c = ratio > 0 ? c_modified : 0, a = ratio > 0 ? 0.5 + c / ratio : 1, b = 1 - a - c;
    for (Index i = 0; i < k_.mesh.cells.n_owned(); ++i) k_.right_side[i] += dt * b * rates_.viscous[i];
    if (ratio > 0)
      for (Index i = 0; i < k_.mesh.cells.n_owned(); ++i)
        k_.right_side[i] += dt * c * from.rates_old.viscous[i];
    solve_viscous(from, k_.w, a);
    weight_ = a;
    for (std::size_t i = 0; i < shear_.size(); ++i) {
      k_.viscous_flux[i] = a * k_.viscous_flux[i] + b * shear_[i];
      if (ratio > 0) k_.viscous_flux[i] += c * from.shear_old[i];
    }
  } else {
    for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) k_.u_p[c] = k_.right_side[c] / k_.step.to->volume[c];
    set_explicit_friction(from, e0, e1);
  }
}

template <int D>
void Predictor<D>::set_explicit_friction(const State<D>& from, double e0, double e1) {
  weight_ = 0;
  if (!k_.step.rate.empty()) {
    k_.viscous_flux = k_.step.shear;
    return;
  }
  for (std::size_t b = 0; b < shear_.size(); ++b)
    k_.viscous_flux[b] = e1 != 0 ? Vec<D>(e0 * shear_[b] + e1 * from.shear_old[b]) : shear_[b];
}

template <int D>
void Predictor<D>::set_rates(const State<D>& from, bool implicit) {
  const bool at_hand = k_.gradient_of != 0 && k_.gradient_of == from.number;
  rate_operator_.apply(from, implicit, k_.oblique, rates_, at_hand ? &k_.velocity_gradient : nullptr);
  wall_flux<D>(k_.mesh, *from.placement, k_.parameters.viscosity, from.u, from.u_boundary, shear_);
  if (k_.bodies)
    for (Index c = 0; c < k_.mesh.cells.n_local(); ++c)
      if (k_.bodies->is_closed(c)) rates_.rate[c].setZero();
  if (!k_.gap_closed()) return;
  for (Index c = 0; c < k_.mesh.cells.n_local(); ++c)
    if (k_.gaps->is_blocked(c)) {
      rates_.rate[c].setZero();
      if (implicit) rates_.viscous[c].setZero();
    }
}

// Volume-integrated at t^{n+1/2}, where the pressure lives that may balance it.
template <int D>
void Predictor<D>::add_body_force(const State<D>& from, double e0, double e1) {
  std::vector<Vec3> places(k_.mesh.cells.n_local(), Vec3::Zero());
  for (std::size_t c = 0; c < places.size(); ++c) places[c].template head<D>() = k_.step.to->centre[c];
  k_.force.assign(places.size(), Vec<D>::Zero());
  if (!body_force_.empty())
    for (int c = 0; c < D; ++c)
      body_force_[c].evaluate(places, k_.by.time + k_.step.dt / 2, flat<D>(k_.force), D, c);
  if (k_.frame) k_.frame->add_force(k_.by.time, k_.step.dt, places, from.u, from.u_old, {e0, e1}, k_.force);
  for (std::size_t c = 0; c < places.size(); ++c)
    k_.right_side[c] += k_.step.dt * k_.step.to->volume[c] * k_.force[c];
}

// sum dV_f u~_f with u~ extrapolated to n+1/2: with the rates of a mesh held still this is the "split" ALE
// form, second order in time and exact for a uniform flow.
template <int D>
void Predictor<D>::add_swept(const State<D>& from, double e0, double e1) {
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    const Index p = k_.mesh.owner[f], n = k_.mesh.neighbour[f];
    Vec<D> value = 0.5 * e0 * (from.u[p] + from.u[n]);
    if (e1 != 0) value += 0.5 * e1 * (from.u_old[p] + from.u_old[n]);
    k_.right_side[p] += k_.step.swept[f] * value;
    k_.right_side[n] -= k_.step.swept[f] * value;
  }
  for (std::size_t b = 0; b < from.u_boundary.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    Vec<D> value = e0 * from.u_boundary[b];
    if (e1 != 0) value += e1 * from.u_boundary_old[b];
    k_.right_side[k_.mesh.owner[f]] += k_.step.swept[f] * value;
  }
}

// Explicit viscous term: -(dt/rho) sum p_f^{n-1/2} (S^{n+1/2} - S^{n+1}), which makes the pressure force
// second order in time on a moving mesh. Implicit: -(dt/rho) sum p_f^{n-1/2} S^{n+1/2}, so that the wall
// velocity is the right boundary value of the predictor; add_back_old_pressure() returns the part on S^{n+1}.
template <int D>
void Predictor<D>::add_old_pressure(const State<D>& from, bool implicit) {
  if (!k_.by.pressure[0]) return;
  const PressureLevel<D>& level = *k_.by.pressure[0];
  const double factor = k_.step.dt / k_.rho;
  const Placement<D>&old = *from.placement, &now = *k_.step.to;
  if (k_.step.swept.empty()) {  // S does not change: the gradient of that step is still at hand
    for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c)
      k_.right_side[c] -= factor * now.volume[c] * level.gradient[c];
    return;
  }
  if (implicit) old_pressure_.assign(k_.right_side.size(), Vec<D>::Zero());
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    const Index p = k_.mesh.owner[f], n = k_.mesh.neighbour[f];
    double value = now.weight[f] * level.p[p] + (1 - now.weight[f]) * level.p[n];
    if (now.skewed()) value += k_.skew_part(now, level.gradient, f);
    const Vec<D> part = factor * value * 0.5 * (old.area[f] - now.area[f]);
    k_.right_side[p] -= part;
    k_.right_side[n] += part;
    if (!implicit) continue;
    const Vec<D> back = factor * value * now.area[f];
    old_pressure_[p] += back;
    old_pressure_[n] -= back;
  }
  if (k_.gap_closed()) part_from_gaps(from, implicit);
  for (std::size_t b = 0; b < level.boundary.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b), p = k_.mesh.owner[f];
    k_.right_side[p] -= factor * level.boundary[b] * 0.5 * (old.area[f] - now.area[f]);
    if (implicit) old_pressure_[p] += factor * level.boundary[b] * now.area[f];
  }
  if (!implicit) return;
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) k_.right_side[c] -= old_pressure_[c];
}

/// As in the gradient of the pressure: a free cell beside a blocked one takes its own value at their face.
template <int D>
void Predictor<D>::part_from_gaps(const State<D>& from, bool implicit) {
  const PressureLevel<D>& level = *k_.by.pressure[0];
  const double factor = k_.step.dt / k_.rho;
  const Placement<D>&old = *from.placement, &now = *k_.step.to;
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    if (!k_.gaps->blocked(f)) continue;
    const Index p = k_.mesh.owner[f], n = k_.mesh.neighbour[f];
    double value = now.weight[f] * level.p[p] + (1 - now.weight[f]) * level.p[n];
    if (now.skewed()) value += k_.skew_part(now, level.gradient, f);
    for (const Index free : {p, n}) {
      if (k_.gaps->is_blocked(free)) continue;
      const double more = (free == p ? 1 : -1) * factor * (level.p[free] - value);
      k_.right_side[free] -= more * 0.5 * (old.area[f] - now.area[f]);
      if (implicit) old_pressure_[free] += more * now.area[f];
    }
  }
}

template <int D>
void Predictor<D>::solve_viscous(const State<D>& from, const Vectors<D>& w, double a) {
  friction_.solve(from, rates_, w, a);
  k_.boundary.close(k_.mesh, *k_.step.to, k_.u_p, w, k_.u_boundary);
  wall_flux<D>(k_.mesh, *k_.step.to, k_.parameters.viscosity, k_.u_p, k_.u_boundary, k_.viscous_flux);
  add_back_old_pressure();
}

template <int D>
void Predictor<D>::add_back_old_pressure() {
  if (!k_.by.pressure[0]) return;
  const PressureLevel<D>& level = *k_.by.pressure[0];
  const double factor = k_.step.dt / k_.rho;
  if (k_.step.swept.empty()) {
    for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) k_.u_p[c] += factor * level.gradient[c];
    return;
  }
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) k_.u_p[c] += old_pressure_[c] / k_.step.to->volume[c];
}

template class Predictor<2>;
template class Predictor<3>;

}  // namespace couplet::fluid
