// SPDX-License-Identifier: Apache-2.0
// Predicted face fluxes and their memory of the mean velocities.
#include "fluid_solver/step/stages.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "fluid_solver/momentum/rates.hpp"

namespace couplet::fluid {
namespace {

// Largest decay of the flux memory per step for which AB2 is stable without overshoot.
constexpr double largest_decay = 2.0 / 3;

/// Weights for add_memory().
struct MemoryWeights {
  double dt, now, before;  // a step, and delta at its middle from that of two levels
};

/// sum nu g + |phi - moved|/2 of each cell. `moved`: flux of the mesh, not read at rest.
template <bool Moving>
[[gnu::always_inline]] inline void sum_evening(const mesh::Mesh& mesh, double nu, const double* conductance,
                                               const double* phi, const double* moved, double* sums) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const double rate = nu * conductance[f] + 0.5 * std::abs(phi[f] - (Moving ? moved[f] : 0.0));
    sums[owner[f]] += rate;
    sums[neighbour[f]] += rate;
  }
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    sums[owner[f]] += nu * conductance[f] + 0.5 * std::abs(phi[f] - (Moving ? moved[f] : 0.0));
}
COUPLET_PROCESSOR_CLONES void evening_pass(const mesh::Mesh& mesh, double nu, const double* conductance,
                                           const double* phi, const double* moved, double* sums) {
  if (moved)
    sum_evening<true>(mesh, nu, conductance, phi, moved, sums);
  else
    sum_evening<false>(mesh, nu, conductance, phi, nullptr, sums);
}

/// phi += delta - min(decay, largest) delta_mid. Appends faces with a larger decay to `far`, which has room
/// for all, and returns their number.
COUPLET_PROCESSOR_CLONES Index memory_pass(const mesh::Mesh& mesh, const MemoryWeights& w, const double* rate,
                                           const double* memory, const double* old, double* phi, Index* far) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const double half = 0.5 * w.dt;
  Index n = 0;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const double decay = half * (rate[owner[f]] + rate[neighbour[f]]);
    far[n] = f;
    n += decay > largest_decay;
    const double mid = old ? w.now * memory[f] + w.before * old[f] : memory[f];
    phi[f] += memory[f] - std::min(decay, largest_decay) * mid;
  }
  return n;
}

}  // namespace

/// phi^p = (mean u^p).S^{n+1} + delta' - (dt/rho) grad p~ . k, delta' on interior faces only.
template <int D>
void FaceFlux<D>::predict(const State<D>& from, const Vectors<D>& u) {
  const Placement<D>& now = *step_.to;
  phi_.resize(mesh_.n_flux_faces());
  // Without pressure the wall velocity is still that of level n; its change comes with grad p.
  if (now.skewed()) scene_.boundary.close(mesh_, now, u, from.w, u_boundary_);
  gradient_.number = 0;
  mean_flux<D>(mesh_, now, scene_.flux_velocity(now, increment_of_fourth() ? without_pressure(u) : u),
               u_boundary_, gradient_.values, phi_);
  for (const Index b : scene_.boundary.rows().of_pressure) {
    const Index f = mesh_.n_interior + b;
    phi_[f] = u[mesh_.owner[f]].dot(now.area[f]);
  }
  scene_.obstacles->carry(now, u, phi_);
  if (scene_.parameters.projection == Projection::incremental)
    add_increment(from);
  else if (!from.memory.empty())
    add_memory(from);
  scene_.obstacles->block(step_, phi_);
}

/// Smoothing rate of cell-to-cell differences by friction and convection, per local cell [1/s]. Uses fluxes
/// relative to the mesh, which are equal in every frame.
template <int D>
void FaceFlux<D>::set_relaxation(const State<D>& from) {
  relaxation_.assign(mesh_.cells.n_local(), 0.0);
  const Placement<D>& at = *from.placement;
  const bool moving = !from.mesh_flux.empty();
  evening_pass(mesh_, scene_.fluid.nu, at.conductance.data(), from.phi.data(),
               moving ? from.mesh_flux.data() : nullptr, relaxation_.data());
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) relaxation_[c] /= at.volume[c];
  mesh_.cells.update_ghosts(relaxation_);
}

/// d delta/dt = e - a delta. e is the effect of the pressure on the flux beyond that on the mean velocity,
/// O(h^2). a is the rate of smoothing by friction and convection, as in implicit momentum interpolation.
/// Without a, the memory would grow forever in a steady flow; without the memory, the steady flow would
/// depend on dt. The decay uses AB2 for small a dt. For large a dt, the projection's dt e would be too much,
/// so with the previous e delta becomes (delta + dt e)/(1 + a dt), and a steady flow keeps e/a for any step.
template <int D>
void FaceFlux<D>::add_memory(const State<D>& from) {
  set_relaxation(from);
  const double ratio = step_.ratio();
  const double now = 1 + ratio / 2, before = -ratio / 2;
  far_.resize(std::size_t(mesh_.n_interior) + 1);
  const Index n_far = memory_pass(mesh_, {step_.dt, now, before}, relaxation_.data(), from.memory.data(),
                                  ratio > 0 ? from.memory_old.data() : nullptr, phi_.data(), far_.data());
  if (!step_.by.pressure[0]) return;
  const Vectors<D>& gradient = scene_.flux_velocity(*from.placement, step_.by.pressure[0]->gradient);
  for (const Index f : std::span(far_).first(n_far)) {
    const double rate = 0.5 * (relaxation_[mesh_.owner[f]] + relaxation_[mesh_.neighbour[f]]);
    const double decay = rate * step_.dt, share = decay / (1 + decay);
    const double mid = ratio > 0 ? now * from.memory[f] + before * from.memory_old[f] : from.memory[f];
    phi_[f] += largest_decay * mid - share * (from.memory[f] + step_.dt * pressure_excess(from, gradient, f));
  }
}

/// Incremental projection: delta' = -dt e^{n-1/2} gives the equation of the increment p - p^{n-1/2}, and the
/// flux keeps dt (e^{n+1/2} - e^{n-1/2}), second order in time. The initial difference of flux and mean
/// velocity decays at the rate a. Removing it at once would be an impulse that stays in checkerboard modes of
/// p.
template <int D>
void FaceFlux<D>::add_increment(const State<D>& from) {
  set_relaxation(from);
  fading_.resize(mesh_.n_interior);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double rate = 0.5 * (relaxation_[mesh_.owner[f]] + relaxation_[mesh_.neighbour[f]]);
    const double decay = rate * step_.dt;
    fading_[f] = from.memory[f] / (1 + decay * (1 + decay / 2));  // exp(-decay) to second order
    phi_[f] += fading_[f];
    if (!step_.by.pressure[0]) continue;
    phi_[f] += step_.dt * (scene_.fourth ? pressure_flux(from, f) / scene_.fluid.rho
                                         : -pressure_excess(from, step_.by.pressure[0]->gradient, f));
  }
}

/// A fourth-order flux already contains the old pressure's gradient in its mean velocity.
template <int D>
bool FaceFlux<D>::increment_of_fourth() const {
  return scene_.fourth && scene_.parameters.projection == Projection::incremental && step_.by.pressure[0];
}

template <int D>
const Vectors<D>& FaceFlux<D>::without_pressure(const Vectors<D>& u) {
  const Vectors<D>& gradient = step_.by.pressure[0]->gradient;
  const double factor = step_.dt / scene_.fluid.rho;
  without_pressure_.resize(u.size());
  for (std::size_t c = 0; c < u.size(); ++c) without_pressure_[c] = u[c] - factor * gradient[c];
  return without_pressure_;
}

/// g (p_N - p_P) + (grad p)_f . k of the pressure of the last step [N/m].
template <int D>
double FaceFlux<D>::pressure_flux(const State<D>& from, Index f) const {
  const Placement<D>& at = *from.placement;
  const PressureLevel<D>& level = *step_.by.pressure[0];
  const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
  const double flux = at.conductance[f] * (level.p[n] - level.p[p]);
  if (at.oblique.empty()) return flux;
  const double w = at.weight[f];
  return flux + (w * level.gradient[p] + (1 - w) * level.gradient[n]).dot(at.oblique[f]);
}

/// e of the last step: effect of its pressure on the flux beyond that on the mean velocity [m^3/s^2].
/// `gradient`: of that pressure, as applied to the flux velocity.
template <int D>
double FaceFlux<D>::pressure_excess(const State<D>& from, const Vectors<D>& gradient, Index f) const {
  const Vec<D> mean = 0.5 * (gradient[mesh_.owner[f]] + gradient[mesh_.neighbour[f]]);
  return (mean.dot(from.placement->area[f]) - pressure_flux(from, f)) / scene_.fluid.rho;
}

template <int D>
void FaceFlux<D>::remember(State<D>& s) {
  s.memory_old.swap(s.memory);
  if (scene_.parameters.projection == Projection::incremental && !fading_.empty()) {
    s.memory.swap(fading_);
  } else {
    s.memory.resize(mesh_.n_interior);
    mean_flux<D>(mesh_, *step_.to, scene_.flux_velocity(*step_.to, s.u), s.u_boundary, gradient_.values,
                 s.memory, s.phi);
    if (step_.to->skewed()) gradient_.number = s.number;
  }
  scene_.obstacles->correct_memory(s);
}

template class FaceFlux<2>;
template class FaceFlux<3>;

}  // namespace couplet::fluid
