// SPDX-License-Identifier: Apache-2.0
// The second and third part of FractionalStep: pressure equation and correction.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/fractional_step.hpp"

namespace couplet::fluid {
namespace {

// Absolute goal of the pressure equation relative to the size of the fluxes: below it there is only
// round-off, on which a relative tolerance would spin (uniform flow, fluid at rest).
constexpr double flux_floor = 3e-15;
constexpr double least_span = 1e-3;
constexpr int oblique_passes = 2;
// The first pass only gives the second one the gradient of its non-orthogonal part: what that share of the
// operator leaves of a looser tolerance.
constexpr double first_pass_tolerance = 10;
constexpr double explosion = 1e3;  // growth of the largest speed in one step that is called divergence

}  // namespace

template <int D>
FractionalStep<D>::FractionalStep(const Mesh& mesh, const Boundary<D>& boundary,
                                  const FluidParameters& parameters, bool moving)
    : mesh_(mesh),
      boundary_(boundary),
      parameters_(parameters),
      rho_(parameters.density),
      nu_(parameters.viscosity / parameters.density),
      rate_operator_(mesh, boundary, nu_),
      viscous_solver_(mesh, boundary),
      pressure_(mesh, boundary, !moving && parameters.bodies.empty()) {
  if (!parameters.bodies.empty()) bodies_ = std::make_unique<ImmersedBodies<D>>(mesh, parameters);
  if (!parameters.body_force.empty()) body_force_ = make_expressions(parameters.body_force, D, "body-force");
  slot_.assign(mesh.cells.n_local(), -1);
  for (std::size_t b = 0; b < boundary.kind().size(); ++b) {
    const Index p = mesh.owner[mesh.n_interior + static_cast<Index>(b)];
    if (boundary.kind()[b] != FaceKind::velocity || slot_[p] >= 0) continue;
    slot_[p] = static_cast<Index>(fits_.size());
    fits_.push_back({});
  }
  for (Index f = 0; f < mesh.n_interior; ++f)
    if (slot_[mesh.owner[f]] >= 0 || slot_[mesh.neighbour[f]] >= 0) near_walls_.push_back(f);
}

template <int D>
void FractionalStep<D>::set_boundary_flux(const Vectors<D>& w) {
  for (std::size_t b = 0; b < w.size(); ++b) {
    if (boundary_.kind()[b] == FaceKind::pressure) continue;
    if (boundary_.kind()[b] == FaceKind::velocity) w_[b] = w[b];
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    phi_p_[f] = w_[b].dot(step_.to->area[f]);
  }
  if (boundary_.closed()) balance_closed_domain();
}

// An incompressible fluid without an outlet needs boundary fluxes that add up to nothing. What a moving wall
// leaves over (discretisation error) is spread over the interface, or over all moving faces, by their area;
// at a convective outlet what flows in elsewhere has to leave.
template <int D>
void FractionalStep<D>::balance_closed_domain() {
  enum { total, size, adjustable_area, other_area };
  double sums[4] = {};
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    const double area = step_.to->area[f].norm();
    sums[total] += phi_p_[f];
    sums[size] += std::abs(phi_p_[f]);
    sums[boundary_.is_adjustable(b) ? adjustable_area : other_area] += area;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const bool adjustable = sums[adjustable_area] > 0;
  if (!adjustable && std::abs(sums[total]) > 1e-6 * sums[size])
    throw Error(
        "The fluid domain is closed, but the given velocities let {:.6g} m^3/s more out than in. Add an "
        "outlet or "
        "correct the velocities.",
        sums[total]);
  const double correction = sums[total] / (adjustable ? sums[adjustable_area] : sums[other_area]);
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    if (adjustable && !boundary_.is_adjustable(b)) continue;
    phi_p_[f] -= correction * step_.to->area[f].norm();
    if (boundary_.is_convective(b)) w_[b] -= correction * step_.to->area[f].normalized();
  }
}

/// phi^p without and with -(dt/rho) grad p~ . k.
template <int D>
void FractionalStep<D>::add_oblique_pressure() {
  const Placement<D>& now = *step_.to;
  const double factor = step_.dt / rho_;
  const Placement<D>& around = pressure_placement();
  phi_p_ = phi_orthogonal_;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double w = now.weight[f];
    phi_p_[f] -=
        factor * (w * gradient_guess_[mesh_.owner[f]] + (1 - w) * gradient_guess_[mesh_.neighbour[f]])
                     .dot(around.oblique_of(f));
  }
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    if (boundary_.kind()[b] == FaceKind::pressure)
      phi_p_[f] -= factor * gradient_guess_[mesh_.owner[f]].dot(now.oblique_of(f));
  }
}

/// On an oblique mesh in passes: the gradient in the non-orthogonal part is that of the steps before in the
/// first, then that of the pass before.
template <int D>
void FractionalStep<D>::project(const State<D>& from, const Vectors<D>& w) {
  gradient_guess_ = gradient_start_;
  const int passes = oblique_ ? oblique_passes : 1;
  for (int pass = 1; pass <= passes; ++pass) {
    if (gradient_guess_.empty())
      phi_p_ = phi_orthogonal_;
    else
      add_oblique_pressure();
    solve_pressure(from, w, (pass < passes ? first_pass_tolerance : 1) * parameters_.pressure_tolerance);
    if (pass == passes) break;
    pressure_gradient(*step_.to, p_, p_boundary_, gradient_guess_);
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) gradient_guess_[c] /= step_.to->volume[c];
    mesh_.cells.update_ghosts(flat<D>(gradient_guess_), D);
  }
  set_forces(from);
}

template <int D>
void FractionalStep<D>::solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance) {
  const Placement<D>& now = *step_.to;
  const double factor = rho_ / step_.dt;
  set_boundary_flux(w);
  p_boundary_.resize(w.size());
  boundary_.pressure_at(from.time + step_.dt / 2, now.boundary_centre, p_boundary_);
  b_.assign(mesh_.cells.n_local(), 0.0);
  double size = 0;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    b_[mesh_.owner[f]] -= factor * phi_p_[f];
    b_[mesh_.neighbour[f]] += factor * phi_p_[f];
    size += phi_p_[f] * phi_p_[f];
  }
  for (std::size_t b = 0; b < w.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    b_[mesh_.owner[f]] -= factor * phi_p_[f];
    size += phi_p_[f] * phi_p_[f];
    if (boundary_.kind()[b] == FaceKind::pressure) b_[mesh_.owner[f]] += now.conductance[f] * p_boundary_[b];
  }
  clear_bodies(b_);
  clear_bodies(p_);
  b_.resize(mesh_.cells.n_owned());
  const double floor = flux_floor * factor * std::sqrt(sum(mesh_.comm, size));
  const SolveStatistics solved =
      pressure_.solve(now, b_, p_, tolerance, std::max(floor, std::numeric_limits<double>::min()));
  statistics_.pressure_iterations += solved.iterations;
  if (bodies_) fill_pressure_in_bodies();
  set_boundary_pressure(from, w);
}

/// Wall: grad p . S = -(rho/dt) (w^{n+1} - w^n).S, the added-mass pressure, exact for a rigidly moving box;
/// p_b = p_P + (grad p . S - grad p~ . k)/g.
template <int D>
void FractionalStep<D>::set_boundary_pressure(const State<D>& from, const Vectors<D>& w) {
  const Placement<D>& now = *step_.to;
  for (std::size_t b = 0; b < w.size(); ++b) {
    if (boundary_.kind()[b] == FaceKind::pressure) continue;
    const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
    const Vec<D> acceleration = (w_[b] - from.w[b]) / step_.dt;
    double normal = -rho_ * acceleration.dot(now.area[f]);
    if (!force_.empty()) normal += rho_ * force_[p].dot(now.area[f]);
    if (!gradient_guess_.empty()) normal -= gradient_guess_[p].dot(now.oblique_of(f));
    p_boundary_[b] = p_[p] + normal / now.conductance[f];
  }
}

/// Pressure on the walls for the load: linear from the cell, p_P + G.(x_b - x_P), with G by least squares
/// over the neighbours, so that it does not know the wall value. The wall value of the scheme itself is first
/// order in the part of the normal gradient that the acceleration does not explain. Cells whose neighbours do
/// not span the space keep that one.
template <int D>
void FractionalStep<D>::extrapolate_to_walls() {
  const Placement<D>& now = *step_.to;
  for (Fit& fit : fits_) fit = {};
  const auto add = [&](Index cell, Index neighbour, const Vec<D>& shift) {
    if (slot_[cell] < 0) return;
    Fit& fit = fits_[slot_[cell]];
    const Vec<D> d = now.centre[neighbour] - now.centre[cell] + shift;
    const double weight = 1 / d.squaredNorm();
    fit.matrix += weight * d * d.transpose();
    fit.side += weight * (p_[neighbour] - p_[cell]) * d;
  };
  for (const Index f : near_walls_) {
    const Vec<D> shift = mesh_.shift(f).template head<D>();
    add(mesh_.owner[f], mesh_.neighbour[f], shift);
    add(mesh_.neighbour[f], mesh_.owner[f], -shift);
  }
  for (Fit& fit : fits_) {
    fit.usable = fit.matrix.determinant() > least_span;  // weights make the entries of order one
    if (fit.usable) fit.side = (fit.matrix.inverse() * fit.side).eval();
  }
  p_wall_ = p_boundary_;
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
    if (boundary_.kind()[b] != FaceKind::velocity || !fits_[slot_[p]].usable) continue;
    p_wall_[b] = p_[p] + fits_[slot_[p]].side.dot(now.boundary_centre[b].template head<D>() - now.centre[p]);
  }
}

template <int D>
void FractionalStep<D>::set_forces(const State<D>& from) {
  extrapolate_to_walls();
  pressure_force_.resize(w_.size());
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    pressure_force_[b] = 0.5 * p_wall_[b] * (from.placement->area[f] + step_.to->area[f]);
  }
}

/// sum p_f S per local cell, p_f linear between the cells; on skewed meshes carried on to the face's centre
/// by the gradient of that: exact for linear p.
template <int D>
void FractionalStep<D>::pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                                          const std::vector<double>& boundary, Vectors<D>& sum) const {
  sum.assign(mesh_.cells.n_local(), Vec<D>::Zero());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index o = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> part = (at.weight[f] * p[o] + (1 - at.weight[f]) * p[n]) * at.area[f];
    sum[o] += part;
    sum[n] -= part;
  }
  for (std::size_t b = 0; b < boundary.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    sum[mesh_.owner[f]] += boundary[b] * at.area[f];
  }
  if (!at.skewed()) return;
  Vectors<D> gradient(sum.size());
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    gradient[c] = at.gradient_cure[c].transpose() * sum[c] / at.volume[c];
  mesh_.cells.update_ghosts(flat<D>(gradient), D);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Vec<D> part = skew_part(at, gradient, f) * at.area[f];
    sum[mesh_.owner[f]] += part;
    sum[mesh_.neighbour[f]] -= part;
  }
}

template <int D>
void FractionalStep<D>::set_gradient(const Placement<D>& at, PressureLevel<D>& level) const {
  pressure_gradient(at, level.p, level.boundary, level.gradient);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) level.gradient[c] /= at.volume[c];
  mesh_.cells.update_ghosts(flat<D>(level.gradient), D);
}

template <int D>
std::shared_ptr<PressureLevel<D>> FractionalStep<D>::pressure_level(const State<D>& from) const {
  auto level = std::make_shared<PressureLevel<D>>();
  level->time = from.time + step_.dt / 2;
  level->p = p_;
  level->boundary = p_boundary_;
  set_gradient(*step_.to, *level);
  return level;
}

/// phi and u at t^{n+1} in the place of phi^p and u^p.
template <int D>
std::shared_ptr<PressureLevel<D>> FractionalStep<D>::correct(const State<D>& from) {
  const Placement<D>& now = *step_.to;
  const std::vector<double>& conductance = pressure_placement().conductance;
  const double factor = step_.dt / rho_;
  for (Index f = 0; f < mesh_.n_interior; ++f)
    phi_p_[f] -= factor * conductance[f] * (p_[mesh_.neighbour[f]] - p_[mesh_.owner[f]]);
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    if (boundary_.kind()[b] == FaceKind::pressure)
      phi_p_[f] -= factor * now.conductance[f] * (p_boundary_[b] - p_[mesh_.owner[f]]);
  }
  auto level = pressure_level(from);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) u_p_[c] -= factor * level->gradient[c];
  mesh_.cells.update_ghosts(flat<D>(u_p_), D);
  if (bodies_) bodies_->force(now, u_p_);
  return level;
}

template <int D>
void FractionalStep<D>::finish(State<D>& s) {
  auto level = correct(s);
  check(s);
  s.phi.swap(phi_p_);
  s.u_old.swap(s.u);
  s.u.swap(u_p_);
  s.number = ++states_;
  s.pressure = {std::move(level), s.pressure[0], s.pressure[1]};
  const std::size_t with_gradient = oblique_ ? 2 : 1;
  if (auto& last = s.pressure[with_gradient]; last && !last->gradient.empty())
    last = std::make_shared<PressureLevel<D>>(PressureLevel<D>{last->time, last->p, last->boundary, {}});
  s.u_boundary_old.swap(s.u_boundary);
  s.w = w_;
  boundary_.close(mesh_, *step_.to, s.u, s.w, s.u_boundary);
  remember_flux(s);
  s.rates_old.rate.swap(rates_.rate);
  s.rates_old.viscous.swap(rates_.viscous);
  s.shear_old.swap(shear_);
  s.placement = step_.to;
  s.points.swap(step_.points);
  s.mesh_flux.swap(step_.swept);
  for (double& flux : s.mesh_flux) flux /= step_.dt;
  s.dt_old = step_.dt;
  s.time += step_.dt;
  if (s.start == Start::at_rest) {  // the multi-step schemes begin after the impulse
    s.start = Start::after_impulse;
    s.dt_old = 0;
  }
  set_eddy_viscosity(s);
}

template <int D>
void FractionalStep<D>::set_eddy_viscosity(State<D>& state) {
  if (parameters_.turbulence) rate_operator_.set_eddy_viscosity(*parameters_.turbulence, state);
}

// One reduction: largest speed at t^{n+1} and where.
template <int D>
void FractionalStep<D>::check(const State<D>& from) {
  struct {
    double value;
    int rank;
  } fastest{-1, comm_rank(mesh_.comm)};
  Index where = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double square = u_p_[c].squaredNorm();
    if (square <= fastest.value) continue;
    fastest.value = std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
    where = c;
  }
  fastest.value = std::sqrt(std::max(fastest.value, 0.0));
  MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh_.comm);
  const bool too_fast = speed_scale_ > 0 && fastest.value > explosion * speed_scale_;
  if (!std::isfinite(fastest.value) || too_fast) {
    Vec3 place = Vec3::Zero();
    place.template head<D>() = step_.to->centre[where];
    double data[4] = {place.x(), place.y(), place.z(), double(mesh_.cell_id[where])};
    MPI_Bcast(data, 4, MPI_DOUBLE, fastest.rank, mesh_.comm);
    throw SolveFailure(
        "The velocity of the fluid {} at t = {:.6g} s in cell {} at ({:.6g}, {:.6g}, {:.6g}) m. Try a "
        "smaller "
        "time step.",
        std::isfinite(fastest.value) ? fmt::format("grew to {:.3g} m/s", fastest.value) : "is not finite",
        from.time + step_.dt, GlobalIndex(data[3]), data[0], data[1], data[2]);
  }
  speed_scale_ = std::max(speed_scale_, fastest.value);
}

template class FractionalStep<2>;
template class FractionalStep<3>;

}  // namespace couplet::fluid
