// SPDX-License-Identifier: Apache-2.0
// The pressure equation of a fractional step.
#include "fluid_solver/pressure/projection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Absolute goal of the pressure equation relative to the size of the fluxes: below it there is only
// round-off, on which a relative tolerance would spin (uniform flow, fluid at rest).
constexpr double flux_floor = 3e-15;
// Up to here two passes of the pressure equation hold after an implicit predictor (measured: 40 hold, 50
// grow).
constexpr double largest_degrees = 40;

}  // namespace

template <int D>
PressureProjection<D>::PressureProjection(StepWork<D>& work, bool moving)
    : k_(work),
      walls_(work.boundary.yields() ? std::make_unique<YieldingWalls<D>>(work) : nullptr),
      pressure_(work.mesh, work.boundary,
                !moving && work.parameters.bodies.empty() && !work.boundary.yields() && work.sound == 0,
                walls_ ? &walls_->couplings() : nullptr) {
  if (work.sound > 0) make_waves();
}

template <int D>
void PressureProjection<D>::assemble() {
  const bool same = k_.assembled && (k_.assembled == k_.step.to ||
                                     (k_.step.to->shape && k_.assembled->shape == k_.step.to->shape));
  const std::array<double, 3> rule = matrix_rule();
  if (same && assembled_yielding_ == k_.step.yields && assembled_rule_ == rule) return;
  if (k_.oblique) set_obliqueness(*k_.step.to);
  pressure_.set(k_.pressure_placement(), k_.step.yields || stores(), admittance(), storage());
  k_.assembled = k_.step.to;
  assembled_yielding_ = k_.step.yields;
  assembled_rule_ = rule;
  if (upstream_) upstream_->respond(pressure_);
}

template <int D>
void PressureProjection<D>::set_obliqueness(const Placement<D>& at) {
  k_.degrees = std::atan(parallel::max(k_.mesh.comm, at.obliqueness)) * 180 / std::numbers::pi;
  k_.very_oblique = k_.degrees > largest_degrees;
}

/// p~ at t^{n+1/2}, the guess of the pressure equation, through the levels at hand (three only where the
/// solver's noise is small), and the gradient to start the non-orthogonal part with, linear in time through
/// the last two. With q < 1 its share of the operator, two passes make that z^2 = q^2 (2 z - 1), |z| = q: no
/// step amplifies it. A parabola would need q < 0.7, a single pass q < 1/3.
template <int D>
void PressureProjection<D>::extrapolate_pressure() {
  const std::size_t order = k_.parameters.pressure_tolerance >= 1e-3 ? 2 : 3;
  const double t = k_.by.time + k_.step.dt / 2;
  std::vector<const PressureLevel<D>*> levels;
  for (std::size_t k = 0; k < order && k_.by.pressure[k]; ++k) levels.push_back(k_.by.pressure[k].get());
  std::array<double, 3> weight{1, 1, 1};
  for (std::size_t k = 0; k < levels.size(); ++k)
    for (std::size_t j = 0; j < levels.size(); ++j)
      if (j != k) weight[k] *= (t - levels[j]->time) / (levels[k]->time - levels[j]->time);
  if (levels.size() == 3) {
    k_.p.resize(k_.mesh.cells.n_local());
    for (std::size_t c = 0; c < k_.p.size(); ++c)
      k_.p[c] = weight[0] * levels[0]->p[c] + weight[1] * levels[1]->p[c] + weight[2] * levels[2]->p[c];
  } else {
    k_.p.assign(k_.mesh.cells.n_local(), 0.0);
    for (std::size_t k = 0; k < levels.size(); ++k)
      for (std::size_t c = 0; c < k_.p.size(); ++c) k_.p[c] += weight[k] * levels[k]->p[c];
  }
  k_.gradient_start.clear();
  if (!k_.oblique || levels.empty()) return;
  k_.gradient_start = levels[0]->gradient;
  if (levels.size() < 2 || levels[1]->gradient.empty()) return;
  const double ahead = (t - levels[0]->time) / (levels[0]->time - levels[1]->time);
  for (std::size_t c = 0; c < k_.gradient_start.size(); ++c)
    k_.gradient_start[c] += ahead * (levels[0]->gradient[c] - levels[1]->gradient[c]);
}

template <int D>
void PressureProjection<D>::set_boundary_flux(const Vectors<D>& w) {
  for (const Index b : k_.boundary.rows().of_velocity) k_.w[b] = w[b];
  for (const Index b : k_.boundary.rows().of_flux) {
    const Index f = k_.mesh.n_interior + b;
    k_.phi_p[f] = k_.w[b].dot(k_.step.to->area[f]);
    if (k_.bodies && k_.bodies->open(f) < 1) k_.phi_p[f] = k_.open_flux(f, k_.phi_p[f]);
  }
  if (k_.boundary.closed() && !k_.step.yields && !stores()) balance_closed_domain();
}

template <int D>
void PressureProjection<D>::solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance,
                                           double answer) {
  const Placement<D>&now = *k_.step.to, &around = k_.pressure_placement();
  const double factor = k_.rho / k_.step.dt;
  set_boundary_flux(w);
  if (k_.step.yields) walls_->foresee(from);
  k_.p_boundary.assign(w.size(), 0.0);
  k_.boundary.pressure_at(k_.by.time + k_.step.dt / 2, now.boundary_centre, k_.p_boundary);
  if (k_.frame)
    for (const Index b : k_.boundary.rows().of_pressure)
      k_.p_boundary[b] -= k_.rho * k_.frame->potential(k_.by.time + k_.step.dt / 2, now.boundary_centre[b]);
  if (absorbing_) absorbing_->foresee(from);
  if (upstream_) upstream_->foresee();
  b_.assign(k_.mesh.cells.n_local(), 0.0);
  double size = subtract_outflow(k_.mesh, factor, k_.phi_p, b_);
  for (std::size_t b = 0; b < w.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    b_[k_.mesh.owner[f]] -= factor * k_.phi_p[f];
    size += k_.phi_p[f] * k_.phi_p[f];
    b_[k_.mesh.owner[f]] += k_.boundary.rows().pressure[b] * around.conductance[f] * k_.p_boundary[b];
  }
  if (k_.gap_closed()) clear_gaps(b_);
  if (k_.bodies) {
    clear_bodies(b_);
    clear_bodies(k_.p);
  }
  b_.resize(k_.mesh.cells.n_owned());
  const double changed = compression_ ? add_waves() : -1;
  const double floor = flux_floor * factor * std::sqrt(parallel::sum(k_.mesh.comm, size));
  const linalg::SolveStatistics solved = pressure_.solve(
      now, b_, k_.p, tolerance, std::max(floor, std::numeric_limits<double>::min()), answer, changed);
  k_.statistics.pressure_iterations += solved.iterations;
  if (k_.bodies) fill_pressure_in_bodies();
  if (k_.step.yields) walls_->follow();
  if (absorbing_) absorbing_->follow();
  set_boundary_pressure(from);
}

/// Wall: grad p . S = -(rho/dt) (w^{n+1} - w^n).S, the added-mass pressure, exact for a rigidly moving box;
/// p_b = p_P + (grad p . S - grad p~ . k)/g.
template <int D>
void PressureProjection<D>::set_boundary_pressure(const State<D>& from) {
  const Placement<D>& now = *k_.step.to;
  for (const Index b : k_.boundary.rows().of_flux) {
    const Index f = k_.mesh.n_interior + b, p = k_.mesh.owner[f];
    const Vec<D> acceleration = (k_.w[b] - from.w[b]) / k_.step.dt;
    double normal = -k_.rho * acceleration.dot(now.area[f]);
    if (!k_.force.empty()) normal += k_.rho * k_.force[p].dot(now.area[f]);
    if (!k_.gradient_guess.empty()) normal -= k_.gradient_guess[p].dot(now.oblique_of(f));
    k_.p_boundary[b] = k_.p[p] + normal / now.conductance[f];
  }
}

/// sum p_f S per local cell, p_f linear between the cells; on skewed meshes carried on to the face's centre
/// by the gradient of that: exact for linear p.
template <int D>
void PressureProjection<D>::pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                                              const std::vector<double>& boundary,
                                              const FluxCorrection* correction, Vectors<D>& sum) const {
  sum.assign(k_.mesh.cells.n_local(), Vec<D>::Zero());
  add_pressure(k_.mesh, at, p, correction, sum);
  for (std::size_t b = 0; b < boundary.size(); ++b) {
    const Index f = k_.mesh.n_interior + static_cast<Index>(b);
    sum[k_.mesh.owner[f]] += boundary[b] * at.area[f];
  }
  if (k_.gap_closed()) part_from_gaps(at, p, sum);
  if (!at.skewed()) return;
  if (k_.bodies) clear_bodies(sum);
  Vectors<D> gradient(sum.size());
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c)
    gradient[c] = at.gradient_cure[c].transpose() * sum[c] / at.volume[c];
  k_.mesh.cells.update_ghosts(flat<D>(gradient), D);
  for (Index f = 0; f < k_.mesh.n_interior; ++f) {
    const Vec<D> part = k_.skew_part(at, gradient, f) * at.area[f];
    sum[k_.mesh.owner[f]] += part;
    sum[k_.mesh.neighbour[f]] -= part;
  }
  if (k_.bodies) clear_bodies(sum);
}

template <int D>
void PressureProjection<D>::set_gradient(const Placement<D>& at, PressureLevel<D>& level,
                                         const FluxCorrection* correction) const {
  pressure_gradient(at, level.p, level.boundary, correction, level.gradient);
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) level.gradient[c] /= at.volume[c];
  k_.mesh.cells.update_ghosts(flat<D>(level.gradient), D);
  if (k_.fourth) k_.fourth->sharpen(at, level.gradient);
}

template <int D>
std::shared_ptr<PressureLevel<D>> PressureProjection<D>::pressure_level(
    const FluxCorrection* correction) const {
  auto level = std::make_shared<PressureLevel<D>>();
  level->time = k_.by.time + k_.step.dt / 2;
  level->p = k_.p;
  level->boundary = k_.p_boundary;
  set_gradient(*k_.step.to, *level, correction);
  if (compression_) compression_->complete(*level);
  if (upstream_) upstream_->complete(*level);
  return level;
}

template <int D>
void PressureProjection<D>::solve_initial(const Placement<D>& at) {
  b_.assign(k_.mesh.cells.n_local(), 0.0);
  double size = 0;
  for (Index f = 0; f < k_.mesh.n_flux_faces(); ++f) {
    b_[k_.mesh.owner[f]] -= k_.phi_p[f];
    if (f < k_.mesh.n_interior) b_[k_.mesh.neighbour[f]] += k_.phi_p[f];
    size += k_.phi_p[f] * k_.phi_p[f];
  }
  if (k_.gap_closed()) clear_gaps(b_);
  if (k_.bodies) clear_bodies(b_);
  b_.resize(k_.mesh.cells.n_owned());
  const double floor = 1e-14 * std::sqrt(parallel::sum(k_.mesh.comm, size));
  pressure_.solve(at, b_, k_.p, std::min(1e-8, k_.parameters.pressure_tolerance),
                  std::max(floor, std::numeric_limits<double>::min()));
  if (k_.bodies) fill_pressure_in_bodies();
}

template class PressureProjection<2>;
template class PressureProjection<3>;

}  // namespace couplet::fluid
