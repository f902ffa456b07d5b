// SPDX-License-Identifier: Apache-2.0
// FractionalStep: the predicted face fluxes and what they remember of the mean velocities.
#include <algorithm>
#include <cmath>

#include "fluid_solver/fractional_step.hpp"

namespace couplet::fluid {
namespace {

// Decay of the flux memory in one step for which its AB2 is stable and does not overshoot.
constexpr double largest_decay = 2.0 / 3;

}  // namespace

/// phi^p = (mean u^p).S^{n+1} + delta' - (dt/rho) grad p~ . k, delta' on interior faces only.
template <int D>
void FractionalStep<D>::predict_flux(const State<D>& from) {
  const Placement<D>& now = *step_.to;
  phi_orthogonal_.resize(mesh_.n_flux_faces());
  // Without the pressure the velocity at a wall is still that of level n: its change comes with grad p.
  if (now.skewed()) boundary_.close(mesh_, now, u_p_, from.w, u_boundary_);
  gradient_of_ = 0;
  mean_flux<D>(mesh_, now, u_p_, u_boundary_, velocity_gradient_, phi_orthogonal_);
  if (parameters_.projection == Projection::incremental)
    add_increment(from);
  else if (!from.memory.empty())
    add_memory(from);
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    if (boundary_.kind()[b] == FaceKind::pressure) phi_orthogonal_[f] = u_p_[mesh_.owner[f]].dot(now.area[f]);
  }
  if (!bodies_) return;
  for (Index f = 0; f < mesh_.n_interior; ++f)
    if (bodies_->blocked(f)) phi_orthogonal_[f] = bodies_->flux(f, now);
}

/// Rate at which friction and convection even out a difference in the cells, per local cell [1/s]. Fluxes
/// relative to the mesh: the same in every frame.
template <int D>
void FractionalStep<D>::set_relaxation(const State<D>& from) {
  relaxation_.assign(mesh_.cells.n_local(), 0.0);
  const Placement<D>& at = *from.placement;
  const bool moving = !from.mesh_flux.empty();
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const double flux = std::abs(from.phi[f] - (moving ? from.mesh_flux[f] : 0.0));
    const double rate = nu_ * at.conductance[f] + 0.5 * flux;
    relaxation_[mesh_.owner[f]] += rate / at.volume[mesh_.owner[f]];
    if (f < mesh_.n_interior) relaxation_[mesh_.neighbour[f]] += rate / at.volume[mesh_.neighbour[f]];
  }
  mesh_.cells.update_ghosts(relaxation_);
}

/// d delta/dt = e - a delta: e is what the pressure does to the flux and not to the mean velocity, O(h^2); a
/// is the rate at which friction and convection would even it out, as in an implicit momentum interpolation.
/// Without a the memory would grow for ever in a steady flow, without the memory the steady flow would depend
/// on dt. The decay is AB2 while a dt is small. Where it is large the projection's own dt e is too much: with
/// the e of the step before delta goes to (delta + dt e)/(1 + a dt), so that a steady flow keeps e/a whatever
/// the step.
template <int D>
void FractionalStep<D>::add_memory(const State<D>& from) {
  set_relaxation(from);
  const double ratio = by_.dt_old > 0 ? step_.dt / by_.dt_old : 0;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double rate = 0.5 * (relaxation_[mesh_.owner[f]] + relaxation_[mesh_.neighbour[f]]);
    const double decay = rate * step_.dt;
    if (decay > largest_decay && by_.pressure[0]) {
      const double share = decay / (1 + decay);
      phi_orthogonal_[f] += from.memory[f] - share * (from.memory[f] + step_.dt * pressure_excess(from, f));
      continue;
    }
    double mid = (1 + ratio / 2) * from.memory[f];
    if (ratio > 0) mid -= ratio / 2 * from.memory_old[f];
    phi_orthogonal_[f] += from.memory[f] - std::min(decay, largest_decay) * mid;
  }
}

/// Incremental projection: with delta' = -dt e^{n-1/2} the equation for p is that of the increment
/// p - p^{n-1/2}, and the flux keeps dt (e^{n+1/2} - e^{n-1/2}), of second order in time. What the start
/// leaves between flux and mean velocity is not taken away at once, which would be an impulse that p never
/// forgets on its checkerboard modes, but fades at the rate a.
template <int D>
void FractionalStep<D>::add_increment(const State<D>& from) {
  set_relaxation(from);
  fading_.resize(mesh_.n_interior);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double rate = 0.5 * (relaxation_[mesh_.owner[f]] + relaxation_[mesh_.neighbour[f]]);
    const double decay = rate * step_.dt;
    fading_[f] = from.memory[f] / (1 + decay * (1 + decay / 2));  // exp(-decay) to second order
    phi_orthogonal_[f] += fading_[f];
    if (by_.pressure[0]) phi_orthogonal_[f] -= step_.dt * pressure_excess(from, f);
  }
}

/// e of the last step: what its pressure does to the flux and not to the mean velocity [m^3/s^2].
template <int D>
double FractionalStep<D>::pressure_excess(const State<D>& from, Index f) const {
  const Placement<D>& at = *from.placement;
  const PressureLevel<D>& level = *by_.pressure[0];
  const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
  const double w = at.weight[f];
  const double flux = at.conductance[f] * (level.p[n] - level.p[p]) +
                      (w * level.gradient[p] + (1 - w) * level.gradient[n]).dot(at.oblique_of(f));
  return (0.5 * (level.gradient[p] + level.gradient[n]).dot(at.area[f]) - flux) / rho_;
}

template <int D>
void FractionalStep<D>::remember_flux(State<D>& s) {
  if (parameters_.projection == Projection::non_incremental) return;
  s.memory_old.swap(s.memory);
  if (parameters_.projection == Projection::incremental && !fading_.empty()) {
    s.memory.swap(fading_);
  } else {
    s.memory.resize(mesh_.n_interior);
    mean_flux<D>(mesh_, *step_.to, s.u, s.u_boundary, velocity_gradient_, s.memory);
    if (step_.to->skewed()) gradient_of_ = s.number;
    for (Index f = 0; f < mesh_.n_interior; ++f) s.memory[f] = s.phi[f] - s.memory[f];
  }
  if (!bodies_) return;
  for (Index f = 0; f < mesh_.n_interior; ++f)
    if (bodies_->blocked(f)) s.memory[f] = 0;
}

template void FractionalStep<2>::predict_flux(const State<2>&);
template void FractionalStep<3>::predict_flux(const State<3>&);
template void FractionalStep<2>::remember_flux(State<2>&);
template void FractionalStep<3>::remember_flux(State<3>&);

}  // namespace couplet::fluid
