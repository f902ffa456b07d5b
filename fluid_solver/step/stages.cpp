// SPDX-License-Identifier: Apache-2.0
// All parts before the face fluxes and the pressure equation.
#include "fluid_solver/step/stages.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"
#include "fluid_solver/momentum/rates.hpp"

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

// Largest decay of the flux memory per step for which AB2 is stable without overshoot.
constexpr double largest_decay = 2.0 / 3;
// Applications of the filter F to the excess e of the pressure: the smooth part is [1 - (1 - F)^2] e.
constexpr int smoothings = 2;

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

/// Perot's vectors of the cells, V E = sum e_f (x_f - x_P), from the fluxes e_f out of each cell [perot2000].
template <int D>
COUPLET_PROCESSOR_CLONES void vectors_pass(const mesh::Mesh& mesh, const Placement<D>& at, const double* flux,
                                           Vectors<D>& vectors) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const bool skewed = at.skewed(), oblique = !at.oblique.empty();
  for (Index f = 0; f < mesh.n_interior; ++f) {
    Vec<D> apart = at.area[f];
    if (oblique) apart -= at.oblique[f];
    apart *= flux[f] / at.conductance[f];
    Vec<D> reach = (1 - at.weight[f]) * apart;
    if (skewed) reach += flux[f] * at.skew[f];
    vectors[owner[f]] += reach;
    vectors[neighbour[f]] += apart - reach;
  }
}

/// Moves (mean E).S from `rest` to `smooth`.
template <int D>
COUPLET_PROCESSOR_CLONES void smooth_pass(const mesh::Mesh& mesh, const Placement<D>& at,
                                          const Vectors<D>& vectors, double* rest, double* smooth) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const double w = at.flux_weight(f);
    const double part = (w * vectors[owner[f]] + (1 - w) * vectors[neighbour[f]]).dot(at.area[f]);
    smooth[f] += part;
    rest[f] -= part;
  }
}

}  // namespace

template <int D>
Predictor<D>::Predictor(const Scene<D>& scene, const FluidStep<D>& step, const KnownGradient<D>& gradient,
                        Prediction<D>& result)
    : scene_(scene),
      mesh_(scene.mesh),
      step_(step),
      gradient_(gradient),
      out_(result),
      rate_operator_(scene.mesh, scene.boundary, scene.fluid.nu,
                     make_momentum_terms<D>(scene.mesh, scene.boundary, scene.parameters)),
      friction_(scene, step, rate_operator_) {}

template <int D>
void Predictor<D>::predict(const State<D>& from, const Vectors<D>& turned) {
  const bool moving = step_.moving(), implicit = step_.by.implicit;
  const double dt = step_.dt, ratio = step_.ratio();
  const double e0 = 1 + ratio / 2, e1 = -ratio / 2;

  set_rates(from, implicit);
  side_.resize(from.u.size());
  out_.u.resize(from.u.size());
  out_.viscous_flux.resize(out_.w.size());
  const bool forced = std::ranges::any_of(scene_.forces, [](const auto& force) { return force->acts(); });
  if (!moving && !implicit && !forced) {
    explicit_pass<D>(std::span(from.placement->volume).first(mesh_.cells.n_owned()), from.u, dt * e0,
                     out_.rates.rate.data(), dt * e1, ratio > 0 ? from.rates_old.rate.data() : nullptr,
                     out_.u);
    return set_explicit_friction(from, e0, e1);
  }
  const std::vector<double>& volume = from.placement->volume;
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    side_[c] = volume[c] * from.u[c] + dt * e0 * out_.rates.rate[c];
  if (ratio > 0)
    for (Index c = 0; c < mesh_.cells.n_local(); ++c) side_[c] += dt * e1 * from.rates_old.rate[c];
  if (forced) add_forces(from, turned, e0, e1);
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
    add_to_surroundings(friction_.boundary_flux(), out_.viscous_flux);
  } else {
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) out_.u[c] = side_[c] / step_.to->volume[c];
    set_explicit_friction(from, e0, e1);
  }
}

template <int D>
void Predictor<D>::set_explicit_friction(const State<D>& from, double e0, double e1) {
  out_.weight = 0;
  for (std::size_t b = 0; b < out_.shear.size(); ++b)
    out_.viscous_flux[b] = e1 != 0 ? Vec<D>(e0 * out_.shear[b] + e1 * from.shear_old[b]) : out_.shear[b];
}

/// Adds the force of terms that let this momentum per density into the fluid [m^4/s^2].
template <int D>
void Predictor<D>::add_to_surroundings(std::span<const Vec<D>> flux, Vectors<D>& force) const {
  for (std::size_t b = 0; b < flux.size(); ++b) force[b] -= scene_.fluid.rho * flux[b];
}

template <int D>
void Predictor<D>::set_rates(const State<D>& from, bool implicit) {
  rate_operator_.apply(from, implicit, scene_.oblique, out_.rates, gradient_.of(from));
  wall_flux<D>(mesh_, *from.placement, scene_.fluid.mu, from.u, from.u_boundary, out_.shear);
  if (!implicit)
    for (const auto& term : rate_operator_.terms()) add_to_surroundings(term->boundary_flux(), out_.shear);
  if (scene_.parameters.rotating_frame) add_wall_convection(from);
  scene_.obstacles->clear(out_.rates.rate);
  scene_.obstacles->clear(out_.rates.viscous);
}

/// The pressure of a wall takes the part W f = sum S S.f/(g V) of the acceleration f in the cell beside it. Convection A is skew;
/// (1 - W) A would do work, and (1 - W) A (1 - W) does none. This adds the right factor, relative to the wall.
template <int D>
void Predictor<D>::add_wall_convection(const State<D>& from) {
  Vectors<D> change(from.u.size(), Vec<D>::Zero());
  for (const Index b : scene_.boundary.rows().of_flux) {
    const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
    const Placement<D>& at = *from.placement;
    change[p] -=
        at.area[f].dot(from.u[p] - from.u_boundary[b]) / (at.conductance[f] * at.volume[p]) * at.area[f];
  }
  mesh_.cells.update_ghosts(flat<D>(change), D);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> carried = 0.5 * from.phi[f] * (change[p] + change[n]);
    out_.rates.rate[p] -= carried;
    out_.rates.rate[n] += carried;
  }
}

// Volume-integrated at t^{n+1/2}, the time of the pressure that may balance it, over the cells in the middle of the step: the swept
// volumes carry what the force adds to the velocity in half a step.
template <int D>
void Predictor<D>::add_forces(const State<D>& from, const Vectors<D>& turned, double e0, double e1) {
  std::vector<Vec3> places(mesh_.cells.n_local(), Vec3::Zero());
  for (std::size_t c = 0; c < places.size(); ++c)
    places[c].template head<D>() = 0.5 * (from.placement->centre[c] + step_.to->centre[c]);
  out_.force.assign(places.size(), Vec<D>::Zero());
  out_.beside_walls.clear();
  if (scene_.parameters.rotating_frame) {
    out_.beside_walls.resize(out_.w.size());
    for (std::size_t b = 0; b < out_.w.size(); ++b) {
      const Index p = mesh_.owner[mesh_.n_interior + static_cast<Index>(b)];
      out_.beside_walls[b] = e0 / step_.to->volume[p] * out_.rates.rate[p];
      if (e1 != 0) out_.beside_walls[b] += e1 / step_.to->volume[p] * from.rates_old.rate[p];
    }
  }
  for (const auto& force : scene_.forces) force->add(step_.begin(), step_.dt, places, turned, out_.force);
  for (const auto& force : scene_.forces) force->add_beside_walls(out_.beside_walls);
  for (std::size_t c = 0; c < places.size(); ++c)
    side_[c] += step_.dt * 0.5 * (from.placement->volume[c] + step_.to->volume[c]) * out_.force[c];
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
  out_.excess.resize(friction_.boundary_flux().size());
  for (std::size_t b = 0; b < out_.excess.size(); ++b)
    out_.excess[b] = scene_.fluid.rho / step_.dt * friction_.added()[mesh_.n_interior + b];
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

/// phi^p = (mean u^p).S^{n+1} + delta' - (dt/rho) grad p~ . k, delta' on interior faces only.
template <int D>
void FaceFlux<D>::predict(const State<D>& from, const Vectors<D>& u) {
  const Placement<D>& now = *step_.to;
  phi_.resize(mesh_.n_flux_faces());
  // Without pressure the wall velocity is still that of level n; its change comes with grad p.
  if (now.skewed()) scene_.boundary.close(mesh_, now, u, from.w, u_boundary_);
  gradient_.number = 0;
  mean_flux<D>(mesh_, now, scene_.flux_velocity(now, u), u_boundary_, gradient_.values, phi_);
  for (const Index b : scene_.boundary.rows().of_pressure) {
    const Index f = mesh_.n_interior + b;
    phi_[f] = u[mesh_.owner[f]].dot(now.area[f]);
  }
  scene_.obstacles->carry(now, u, phi_);
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
  for (std::size_t f = 0; f < from.excess.size(); ++f) {
    const double rate = from.excess[f] * at.conductance[f];
    relaxation_[mesh_.owner[f]] += rate;
    if (f < std::size_t(mesh_.n_interior)) relaxation_[mesh_.neighbour[f]] += rate;
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) relaxation_[c] /= at.volume[c];
  mesh_.cells.update_ghosts(relaxation_);
}

/// d delta/dt = e - F e - a delta. e is the effect of the pressure on the flux beyond that on the mean velocity,
/// O(h^2). Its smooth part F e of the last pressure enters the flux in advance, as in an incremental projection,
/// so that a steady flow loses nothing to it. The rest alternates between cells. a is the rate of its smoothing by
/// friction and convection, as in implicit momentum interpolation. Without a, the memory would grow forever in a
/// steady flow; without the memory, the pressure would keep a rest that depends on dt. The decay uses AB2 for
/// small a dt. For large a dt, the projection's dt e would be too much, so with the previous e delta becomes
/// (delta + dt e)/(1 + a dt), and a steady flow keeps e/a for any step.
template <int D>
void FaceFlux<D>::add_memory(const State<D>& from) {
  set_relaxation(from);
  const double ratio = step_.ratio();
  const double now = 1 + ratio / 2, before = -ratio / 2;
  far_.resize(std::size_t(mesh_.n_interior) + 1);
  const Index n_far = memory_pass(mesh_, {step_.dt, now, before}, relaxation_.data(), from.memory.data(),
                                  ratio > 0 ? from.memory_old.data() : nullptr, phi_.data(), far_.data());
  far_.resize(n_far);
  ahead_.assign(mesh_.n_interior, 0.0);
  if (!step_.guess || (n_far == 0 && !scene_.has_smooth_excess())) return;
  if (smooth_of_ != step_.guess) split_excess(guess_at(from), step_.guess);
  ahead_ = smooth_;
  for (const Index f : far_) {
    const double rate = 0.5 * (relaxation_[mesh_.owner[f]] + relaxation_[mesh_.neighbour[f]]);
    const double decay = rate * step_.dt, share = decay / (1 + decay);
    const double mid = ratio > 0 ? now * from.memory[f] + before * from.memory_old[f] : from.memory[f];
    phi_[f] += largest_decay * mid - share * (from.memory[f] + step_.dt * rest_[f]);
  }
  for (Index f = 0; f < mesh_.n_interior; ++f) phi_[f] -= step_.dt * ahead_[f];
}

/// Splits e of a pressure into its smooth part and the rest; where none of it is smooth, all is rest.
template <int D>
void FaceFlux<D>::split_excess(const Placement<D>& at, std::shared_ptr<const PressureLevel<D>> of) {
  smooth_of_ = std::move(of);
  const PressureLevel<D>& level = *smooth_of_;
  const Vectors<D>& gradient = scene_.flux_velocity(at, level.gradient);
  rest_.resize(mesh_.n_interior);
  for (Index f = 0; f < mesh_.n_interior; ++f) rest_[f] = pressure_excess(at, level, gradient, f);
  smooth_.assign(rest_.size(), 0.0);
  for (int k = 0; k < smoothings && scene_.has_smooth_excess(); ++k) {
    vectors_.assign(mesh_.cells.n_local(), Vec<D>::Zero());
    vectors_pass<D>(mesh_, at, rest_.data(), vectors_);
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) vectors_[c] /= at.volume[c];
    mesh_.cells.update_ghosts(flat<D>(vectors_), D);
    smooth_pass<D>(mesh_, at, vectors_, rest_.data(), smooth_.data());
  }
}

/// Placement on which the gradient of the predictor's pressure was computed.
template <int D>
const Placement<D>& FaceFlux<D>::guess_at(const State<D>& from) const {
  return step_.guess == step_.by.pressure[0] ? *from.placement : *step_.to;
}

/// e of a pressure: acceleration of the flux by g (p_N - p_P) + (grad p)_f . k, less that of the mean of
/// the cells' velocities [m^3/s^2]. `gradient`: gradient of that pressure, as applied to the flux velocity.
template <int D>
double FaceFlux<D>::pressure_excess(const Placement<D>& at, const PressureLevel<D>& level,
                                    const Vectors<D>& gradient, Index f) const {
  const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
  const double of_owner = at.flux_weight(f);
  double excess = (of_owner * gradient[p] + (1 - of_owner) * gradient[n]).dot(at.area[f]) -
                  at.conductance[f] * (level.p[n] - level.p[p]);
  if (!at.oblique.empty()) {
    const double w = at.weight[f];
    excess -= (w * level.gradient[p] + (1 - w) * level.gradient[n]).dot(at.oblique[f]);
  }
  return excess / scene_.fluid.rho;
}

template <int D>
void FaceFlux<D>::remember(State<D>& s) {
  s.memory_old.swap(s.memory);
  s.memory.resize(mesh_.n_interior);
  mean_flux<D>(mesh_, *step_.to, scene_.flux_velocity(*step_.to, s.u), s.u_boundary, gradient_.values,
               s.memory, s.phi);
  if (step_.to->skewed()) gradient_.number = s.number;
  if (s.pressure[0] && scene_.has_smooth_excess()) {
    // The change of F e in the step is not remembered: it would leave an error of first order in time.
    split_excess(*step_.to, s.pressure[0]);
    for (Index f = 0; f < mesh_.n_interior; ++f) s.memory[f] -= step_.dt * (smooth_[f] - ahead_[f]);
  }
  scene_.obstacles->correct_memory(s);
}

template class FaceFlux<2>;
template class FaceFlux<3>;

}  // namespace couplet::fluid
