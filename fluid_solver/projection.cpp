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
// A closed domain: share of the boundary fluxes that a moving wall may leave over as an error of
// discretisation, and the speed below which there is no flow [m/s].
constexpr double largest_leftover = 0.1, least_speed = 1e-9;
constexpr int oblique_passes = 2, most_oblique_passes = 200;
constexpr double standing = 1e-3;  // change of the pressure gradient in a pass
// The first pass only gives the second one the gradient of its non-orthogonal part: what that share of the
// operator leaves of a looser tolerance.
constexpr double first_pass_tolerance = 10;

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
      energy_guard_(mesh, boundary, parameters.density, parameters.viscosity),
      pressure_(mesh, boundary, !moving && parameters.bodies.empty()) {
  if (!parameters.bodies.empty()) bodies_ = std::make_unique<ImmersedBodies<D>>(mesh, parameters);
  if (!parameters.body_force.empty()) body_force_ = make_expressions(parameters.body_force, D, "body-force");
  for (std::size_t b = 0; b < boundary.kind().size(); ++b)
    if (boundary.is_interface(static_cast<Index>(b))) interface_faces_.push_back(static_cast<Index>(b));
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
  if (adjustable && !boundary_.has_convective_outlet() &&
      std::abs(sums[total]) > largest_leftover * sums[size] &&
      sums[size] > least_speed * (sums[adjustable_area] + sums[other_area]))
    throw Error(
        "The fluid domain is closed: at t = {:.6g} s {:.6g} m^3/s more flow out than in, and neither the "
        "given velocities "
        "nor the motion of the interface make up for it. What a pressure level would have to push through "
        "the interface "
        "is not computed: give the fluid an outlet (a small one far from the interface will do).",
        by_.time + step_.dt, sums[total]);
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
/// first, then that of the pass before. Two are enough where no old pressure is in the predictor (|z| = q,
/// see extrapolate_pressure()) or q is small; an implicit predictor gives the old one back unsmoothed, and
/// what two passes leave of it grows from about 45 degrees on: there the passes go on until the gradient
/// stands.
template <int D>
void FractionalStep<D>::project(const State<D>& from, const Vectors<D>& w) {
  level_.reset();
  gradient_guess_ = gradient_start_;
  const bool to_the_end = oblique_ && by_.implicit && very_oblique_;
  const int passes = to_the_end ? most_oblique_passes : oblique_ ? oblique_passes : 1;
  for (int pass = 1; pass <= passes; ++pass) {
    if (gradient_guess_.empty())
      phi_p_ = phi_orthogonal_;
    else
      add_oblique_pressure();
    solve_pressure(from, w, (pass < passes ? first_pass_tolerance : 1) * parameters_.pressure_tolerance);
    if (pass == passes && to_the_end)
      throw SolveFailure(
          "The non-orthogonal part of the pressure equation did not converge in {} passes at t = {:.6g} s: "
          "the "
          "mesh is too oblique, {:.0f} degrees between a face and the line of its cells.",
          passes, by_.time + step_.dt, degrees_);
    if (pass == passes) break;
    if (to_the_end) gradient_before_ = gradient_guess_;
    pressure_gradient(*step_.to, p_, p_boundary_, gradient_guess_);
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) gradient_guess_[c] /= step_.to->volume[c];
    mesh_.cells.update_ghosts(flat<D>(gradient_guess_), D);
    if (to_the_end && pass >= oblique_passes && gradient_stands()) break;
  }
  set_forces(from);
  correct_shear();
}

template <int D>
bool FractionalStep<D>::gradient_stands() const {
  double sums[2] = {0, 0};
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    if (!gradient_before_.empty()) sums[0] += (gradient_guess_[c] - gradient_before_[c]).squaredNorm();
    sums[1] += gradient_guess_[c].squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  return !gradient_before_.empty() && sums[0] <= standing * standing * sums[1];
}

// The viscous force of the prediction is kept: each project() corrects that of the guess, not the last one.
template <int D>
void FractionalStep<D>::remember_prediction(bool implicit) {
  shear_weight_ = implicit ? 0.5 : 0.0;
  w_predicted_.resize(interface_faces_.size());
  shear_predicted_.resize(interface_faces_.size());
  for (std::size_t i = 0; i < interface_faces_.size(); ++i) {
    w_predicted_[i] = w_[interface_faces_[i]];
    shear_predicted_[i] = viscous_force_[interface_faces_[i]];
  }
}

/// Shear of the current wall velocity, F - theta mu g [c - (c.n) n], c = w - w*: left at the guess w* the
/// slip c would come as a force one step late, at a two-step oscillation a mass of -mu g dt. The explicit
/// branch takes the shear of level n, which knows its wall velocity.
template <int D>
void FractionalStep<D>::correct_shear() {
  if (shear_weight_ == 0) return;
  for (std::size_t i = 0; i < interface_faces_.size(); ++i) {
    const Index b = interface_faces_[i], f = mesh_.n_interior + b;
    const Vec<D> n = step_.to->area[f].normalized(), c = w_[b] - w_predicted_[i];
    viscous_force_[b] = shear_predicted_[i] -
                        shear_weight_ * parameters_.viscosity * step_.to->conductance[f] * (c - c.dot(n) * n);
  }
}

template <int D>
void FractionalStep<D>::solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance) {
  const Placement<D>& now = *step_.to;
  const double factor = rho_ / step_.dt;
  set_boundary_flux(w);
  p_boundary_.resize(w.size());
  boundary_.pressure_at(by_.time + step_.dt / 2, now.boundary_centre, p_boundary_);
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
std::shared_ptr<PressureLevel<D>> FractionalStep<D>::pressure_level() const {
  auto level = std::make_shared<PressureLevel<D>>();
  level->time = by_.time + step_.dt / 2;
  level->p = p_;
  level->boundary = p_boundary_;
  set_gradient(*step_.to, *level);
  return level;
}

template class FractionalStep<2>;
template class FractionalStep<3>;

}  // namespace couplet::fluid
