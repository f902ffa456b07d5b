// SPDX-License-Identifier: Apache-2.0
// All parts before the face fluxes and the pressure equation.
#include "fluid_solver/step/stages.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"

namespace couplet::fluid {
namespace {

// Modified Crank-Nicolson a L u^{n+1} + b L u^n + c L u^{n-1}: second order for any step ratio, damps stiff
// modes.
constexpr double c_modified = 1.0 / 16;

/// u + (a R + b R_old)/V, an explicit step on a fixed mesh without forces. `old`: nullptr if there is none.
template <int D>
COUPLET_PROCESSOR_CLONES void explicit_pass(std::span<const double> volume, const Vectors<D>& u, double a,
                                            const Vec<D>* rate, double b, const Vec<D>* old, Vectors<D>& to) {
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

}  // namespace

template <int D>
Predictor<D>::Predictor(const Scene<D>& scene, const Step<D>& step, const KnownGradient<D>& gradient,
                        Prediction<D>& result)
    : scene_(scene),
      mesh_(scene.mesh),
      step_(step),
      gradient_(gradient),
      out_(result),
      rate_operator_(scene.mesh, scene.boundary, scene.fluid.nu, scene.is_compressible()),
      friction_(scene, step, rate_operator_) {}

template <int D>
void Predictor<D>::predict(const State<D>& from) {
  const bool moving = step_.moving(), implicit = step_.by.implicit;
  const double dt = step_.dt, ratio = step_.ratio();
  const double e0 = 1 + ratio / 2, e1 = -ratio / 2;

  const bool given = !step_.rate.empty();
  if (!given) set_rates(from, implicit);
  side_.resize(from.u.size());
  out_.u.resize(from.u.size());
  out_.viscous_flux.resize(out_.w.size());
  const bool forced =
      scene_.frame || (!scene_.body_force.empty() && !std::ranges::all_of(scene_.balanced, std::identity()));
  if (!moving && !implicit && !given && !forced) {
    explicit_pass<D>(std::span(from.placement->volume).first(mesh_.cells.n_owned()), from.u, dt * e0,
                     out_.rates.rate.data(), dt * e1, ratio > 0 ? from.rates_old.rate.data() : nullptr,
                     out_.u);
    return set_explicit_friction(from, e0, e1);
  }
  const std::vector<double>& volume = from.placement->volume;
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    side_[c] = volume[c] * from.u[c] + (given ? dt * step_.rate[c] : dt * e0 * out_.rates.rate[c]);
  if (ratio > 0 && !given)
    for (Index c = 0; c < mesh_.cells.n_local(); ++c) side_[c] += dt * e1 * from.rates_old.rate[c];
  if (forced) add_body_force(from, e0, e1);
  if (moving) add_swept(from, e0, e1);
  if (moving || implicit) add_old_pressure(from, implicit);
  if (implicit) {
    const double c = ratio > 0 ? c_modified : 0, a = ratio > 0 ? 0.5 + c / ratio : 1, b = 1 - a - c;
    for (Index i = 0; i < mesh_.cells.n_owned(); ++i) side_[i] += dt * b * out_.rates.viscous[i];
    if (ratio > 0)
      for (Index i = 0; i < mesh_.cells.n_owned(); ++i) side_[i] += dt * c * from.rates_old.viscous[i];
    solve_viscous(from, a);
    out_.weight = a;
    for (std::size_t i = 0; i < out_.shear.size(); ++i) {
      out_.viscous_flux[i] = a * out_.viscous_flux[i] + b * out_.shear[i];
      if (ratio > 0) out_.viscous_flux[i] += c * from.shear_old[i];
    }
  } else {
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) out_.u[c] = side_[c] / step_.to->volume[c];
    set_explicit_friction(from, e0, e1);
  }
}

template <int D>
void Predictor<D>::set_explicit_friction(const State<D>& from, double e0, double e1) {
  out_.weight = 0;
  if (!step_.rate.empty()) {
    out_.viscous_flux = step_.shear;
    return;
  }
  for (std::size_t b = 0; b < out_.shear.size(); ++b)
    out_.viscous_flux[b] = e1 != 0 ? Vec<D>(e0 * out_.shear[b] + e1 * from.shear_old[b]) : out_.shear[b];
}

template <int D>
void Predictor<D>::set_rates(const State<D>& from, bool implicit) {
  rate_operator_.apply(from, implicit, scene_.oblique, out_.rates, gradient_.of(from));
  wall_flux<D>(mesh_, *from.placement, scene_.fluid.mu, from.u, from.u_boundary, out_.shear);
  scene_.obstacles->clear(out_.rates.rate);
  scene_.obstacles->clear(out_.rates.viscous);
}

// Volume-integrated at t^{n+1/2}, the time of the pressure that may balance it.
template <int D>
void Predictor<D>::add_body_force(const State<D>& from, double e0, double e1) {
  std::vector<Vec3> places(mesh_.cells.n_local(), Vec3::Zero());
  for (std::size_t c = 0; c < places.size(); ++c) places[c].template head<D>() = step_.to->centre[c];
  out_.force.assign(places.size(), Vec<D>::Zero());
  for (std::size_t c = 0; c < scene_.body_force.size(); ++c)
    if (!scene_.balanced[c])
      scene_.body_force[c].evaluate(places, step_.middle(), flat<D>(out_.force), D, int(c));
  if (scene_.frame)
    scene_.frame->add_force(step_.begin(), step_.dt, places, from.u, from.u_old, {e0, e1}, out_.force);
  for (std::size_t c = 0; c < places.size(); ++c) side_[c] += step_.dt * step_.to->volume[c] * out_.force[c];
}

// sum dV_f u~_f with u~ extrapolated to n+1/2. With rates on a fixed mesh this is the "split" ALE form,
// second order in time and exact for uniform flow.
template <int D>
void Predictor<D>::add_swept(const State<D>& from, double e0, double e1) {
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    Vec<D> value = 0.5 * e0 * (from.u[p] + from.u[n]);
    if (e1 != 0) value += 0.5 * e1 * (from.u_old[p] + from.u_old[n]);
    side_[p] += step_.swept[f] * value;
    side_[n] -= step_.swept[f] * value;
  }
  for (std::size_t b = 0; b < from.u_boundary.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    Vec<D> value = e0 * from.u_boundary[b];
    if (e1 != 0) value += e1 * from.u_boundary_old[b];
    side_[mesh_.owner[f]] += step_.swept[f] * value;
  }
}

// Explicit viscous term: -(dt/rho) sum p_f^{n-1/2} (S^{n+1/2} - S^{n+1}) makes the pressure force second
// order in time on a moving mesh. Implicit: -(dt/rho) sum p_f^{n-1/2} S^{n+1/2} makes the wall velocity the
// correct boundary value of the predictor; add_back_old_pressure() returns the part on S^{n+1}.
template <int D>
void Predictor<D>::add_old_pressure(const State<D>& from, bool implicit) {
  if (!step_.guess) return;
  const PressureLevel<D>& level = *step_.guess;
  const double factor = step_.dt / scene_.fluid.rho;
  const Placement<D>&old = *from.placement, &now = *step_.to;
  if (!step_.moving()) {  // S does not change: the gradient of that step is still at hand
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) side_[c] -= factor * now.volume[c] * level.gradient[c];
    return;
  }
  if (implicit) old_pressure_.assign(side_.size(), Vec<D>::Zero());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    double value = now.weight[f] * level.p[p] + (1 - now.weight[f]) * level.p[n];
    if (now.skewed()) value += skew_part<D>(mesh_, now, level.gradient, f);
    const Vec<D> part = factor * value * 0.5 * (old.area[f] - now.area[f]);
    side_[p] -= part;
    side_[n] += part;
    if (!implicit) continue;
    const Vec<D> back = factor * value * now.area[f];
    old_pressure_[p] += back;
    old_pressure_[n] -= back;
  }
  if (scene_.obstacles->parts()) {
    Vectors<D> more(old.area.size());
    for (std::size_t f = 0; f < more.size(); ++f) more[f] = -factor * 0.5 * (old.area[f] - now.area[f]);
    scene_.obstacles->part(now, level.p, &level.gradient, more, side_);
    for (std::size_t f = 0; implicit && f < more.size(); ++f) more[f] = factor * now.area[f];
    if (implicit) scene_.obstacles->part(now, level.p, &level.gradient, more, old_pressure_);
  }
  for (std::size_t b = 0; b < level.boundary.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
    side_[p] -= factor * level.boundary[b] * 0.5 * (old.area[f] - now.area[f]);
    if (implicit) old_pressure_[p] += factor * level.boundary[b] * now.area[f];
  }
  if (!implicit) return;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) side_[c] -= old_pressure_[c];
}

template <int D>
void Predictor<D>::solve_viscous(const State<D>& from, double a) {
  friction_.solve(from, out_.rates, out_.w, a, side_, out_.u);
  scene_.boundary.close(mesh_, *step_.to, out_.u, out_.w, u_boundary_);
  wall_flux<D>(mesh_, *step_.to, scene_.fluid.mu, out_.u, u_boundary_, out_.viscous_flux);
  add_back_old_pressure();
}

template <int D>
void Predictor<D>::add_back_old_pressure() {
  if (!step_.guess) return;
  const PressureLevel<D>& level = *step_.guess;
  const double factor = step_.dt / scene_.fluid.rho;
  if (!step_.moving()) {
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) out_.u[c] += factor * level.gradient[c];
    return;
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) out_.u[c] += old_pressure_[c] / step_.to->volume[c];
}

template class Predictor<2>;
template class Predictor<3>;

}  // namespace couplet::fluid
