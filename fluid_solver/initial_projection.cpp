// SPDX-License-Identifier: Apache-2.0
// FractionalStep: the initial velocity made free of divergence.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"
#include "fluid_solver/fractional_step.hpp"

namespace couplet::fluid {

template <int D>
void FractionalStep<D>::solve_initial(const Placement<D>& at) {
  b_.assign(mesh_.cells.n_local(), 0.0);
  double size = 0;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    b_[mesh_.owner[f]] -= phi_p_[f];
    if (f < mesh_.n_interior) b_[mesh_.neighbour[f]] += phi_p_[f];
    size += phi_p_[f] * phi_p_[f];
  }
  clear_bodies(b_);
  b_.resize(mesh_.cells.n_owned());
  const double floor = 1e-14 * std::sqrt(sum(mesh_.comm, size));
  pressure_.solve(at, b_, p_, std::min(1e-8, parameters_.pressure_tolerance),
                  std::max(floor, std::numeric_limits<double>::min()));
  if (bodies_) fill_pressure_in_bodies();
}

/// u = u0 - grad psi with phi free of divergence: the same equation with dt = 1 s, rho = 1. Where the given
/// wall velocity differs from u0 at the wall (an inlet that starts at once) the field becomes the potential
/// flow.
template <int D>
void FractionalStep<D>::project_initial(State<D>& s) {
  oblique_ = max(mesh_.comm, s.placement->obliqueness) > orthogonal || !s.points.empty();
  const Placement<D>& at = *s.placement;
  set_obliqueness(at);
  phi_p_.assign(mesh_.n_flux_faces(), 0.0);
  mean_flux<D>(mesh_, at, s.u, s.u_boundary, velocity_gradient_, phi_p_);
  for (std::size_t b = 0; b < s.w.size(); ++b)
    phi_p_[mesh_.n_interior + b] = s.u_boundary[b].dot(at.area[mesh_.n_interior + b]);
  step_ = {rho_, s.placement, {}, {}};  // dt/rho = 1
  by_ = s;
  right_side_.resize(s.u.size());
  if (bodies_) {
    mark_bodies(s.time);
    bodies_->force(at, s.u);
    for (Index f = 0; f < mesh_.n_interior; ++f)
      if (bodies_->blocked(f)) phi_p_[f] = bodies_->flux(f, at);
  }
  w_ = s.w;
  gradient_guess_.clear();
  u_p_ = s.u;
  p_.assign(mesh_.cells.n_local(), 0.0);
  p_boundary_.assign(s.w.size(), 0.0);
  pressure_.set(pressure_placement());
  assembled_ = s.placement;
  const Vectors<D> jump_from = s.u_boundary;
  set_boundary_flux(s.w);
  solve_initial(at);
  for (std::size_t b = 0; b < s.w.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    if (boundary_.kind()[b] == FaceKind::pressure) continue;
    p_boundary_[b] = p_[mesh_.owner[f]] - (s.w[b] - jump_from[b]).dot(at.area[f]) / at.conductance[f];
  }
  correct();
  s.phi.swap(phi_p_);
  s.u.swap(right_side_);
  s.w = w_;
  s.u_old.clear();
  s.pressure = {};
  boundary_.close(mesh_, at, s.u, s.w, s.u_boundary);
  remember_flux(s);
}

template void FractionalStep<2>::solve_initial(const Placement<2>&);
template void FractionalStep<3>::solve_initial(const Placement<3>&);
template void FractionalStep<2>::project_initial(State<2>&);
template void FractionalStep<3>::project_initial(State<3>&);

}  // namespace couplet::fluid
