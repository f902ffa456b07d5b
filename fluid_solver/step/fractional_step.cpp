// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/fractional_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// At an interface the viscous flux uses the current wall velocity, F - a mu g (c_t + 4 c_n) with tangential
/// and normal parts of c = w - w*. With the guess w*, c would act as a force one step late, for a two-step
/// oscillation like a mass of -mu g dt. The factor of c_n is empirical. A wall with a fortieth of its added
/// mass (nu dt/h^2 = 100) diverges with 0.5 or less, and oscillates by 0.32 with 1, 0.16 with 2 and 0.08 with
/// 4; 0.15 is smooth. c decreases with the square of the step. The explicit branch uses the flux of level n.
template <int D>
void Loads<D>::set(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                   const Projected<D>& projected, const State<D>& from) {
  const Placement<D>& to = *step.to;
  pressure.resize(projected.w.size());
  viscous.resize(projected.w.size());
  const auto potential = scene.potential(step.middle());
  for (std::size_t b = 0; b < projected.w.size(); ++b) {
    const Index f = scene.mesh.n_interior + static_cast<Index>(b);
    const Vec<D> n = to.area[f].normalized();
    Vec<D> flux = prediction.viscous_flux[b];
    if (prediction.weight != 0 && scene.boundary.is_interface(static_cast<Index>(b))) {
      const Vec<D> c = projected.w[b] - prediction.w[b];
      const double mu =
          prediction.weight * scene.fluid.mu + (prediction.excess.empty() ? 0 : prediction.excess[b]);
      flux -= mu * to.conductance[f] * (c + 3 * c.dot(n) * n);
    }
    double p = projected.boundary[b];
    if (!projected.rotational.empty()) p += projected.rotational[scene.mesh.owner[f]];
    if (potential) p += scene.fluid.rho * potential(to.boundary_centre[b]);
    const Vec<D> normal = flux.dot(n) * n;
    pressure[b] = 0.5 * p * (from.placement->area[f] + to.area[f]) + normal;
    viscous[b] = flux - normal;
  }
}

template struct Loads<2>;
template struct Loads<3>;

namespace {

// Share of cells and directions with lines above which fourth order pays off.
constexpr double least_share_of_lines = 0.5;
constexpr double explosion = 1e3;  // growth of the largest speed in one step that is called divergence

COUPLET_PROCESSOR_CLONES void velocity_pass(std::span<const double> predicted, double factor,
                                            std::span<const double> gradient, std::span<double> u) {
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = predicted[i] - factor * gradient[i];
}

/// Largest speed; infinity if one is not finite.
template <int D>
COUPLET_PROCESSOR_CLONES double largest_square(std::span<const Vec<D>> u) {
  double largest = 0, all = 0;
  for (const Vec<D>& v : u) {
    const double square = v.squaredNorm();
    largest = std::max(largest, square);
    all += square;
  }
  return std::isfinite(all) ? largest : std::numeric_limits<double>::infinity();
}

}  // namespace

template <int D>
FractionalStep<D>::FractionalStep(const mesh::Mesh& mesh, const std::vector<Vec3>& points_at_rest,
                                  const Boundary<D>& boundary, const FluidParameters& parameters, bool moving)
    : mesh_(mesh),
      scene_{mesh, points_at_rest, boundary, parameters, parameters.properties()},
      predictor_(scene_, step_, gradient_, prediction_),
      flux_(scene_, step_, gradient_),
      projection_(scene_, step_, prediction_, projected_, moving),
      energy_check_(mesh, boundary, scene_.fluid, parameters.pressure_tolerance) {
  scene_.forces = make_forces<D>(mesh, boundary, parameters);
  scene_.obstacles = make_obstacles<D>(mesh, parameters, points_at_rest);
  bodies_ = dynamic_cast<const ImmersedBodies<D>*>(scene_.obstacles.get());
  gaps_ = dynamic_cast<const Gaps<D>*>(scene_.obstacles.get());
  if (!parameters.heat) return;
  heat_ = std::make_unique<HeatTransport<D>>(scene_, step_);
  if (parameters.heat->is_buoyant())
    scene_.forces.push_back(std::make_unique<Buoyancy<D>>(mesh, *heat_, *parameters.heat));
}

template <int D>
std::shared_ptr<const Placement<D>> FractionalStep<D>::raise_order(std::shared_ptr<const Placement<D>> at) {
  Lines<D> lines(mesh_, *at);
  if (scene_.parameters.face_values == FaceValues::automatic) {
    const bool pays = lines.share >= least_share_of_lines;
    log::info("Face values: {} (auto: fourth order is possible on {:.0f} % of the mesh)",
              pays ? "fourth-order" : "second-order", 100 * lines.share);
    if (!pays) return at;
  }
  auto seen = lines.seen(mesh_, *at);
  scene_.fourth = std::make_unique<FourthOrder<D>>(mesh_, std::move(lines));
  predictor_.rate_operator().set_fourth(scene_.fourth.get());
  return seen;
}

/// Updates the obstacles to the end of the step.
template <int D>
void FractionalStep<D>::mark(double time) {
  using Changed = typename Obstacles<D>::Changed;
  const Changed changed = scene_.obstacles->mark(time, step_.to, scene_.points_of(step_));
  if (changed != Changed::nothing) projection_.forget_matrix();
  if (changed == Changed::cells) projection_.equation().refresh();
}

template <int D>
void FractionalStep<D>::predict(const State<D>& from, const FlowHistory<D>& by, SubStep<D> step,
                                const Vectors<D>& w) {
  step_ = {std::move(step), by};
  level_.reset();
  prediction_.w = w;
  if (step_.moving())
    for (const Index b : scene_.boundary.rows().of_mesh) {
      const Index f = mesh_.n_interior + b;
      prediction_.w[b] = step_.swept[f] / (step_.dt * step_.to->area[f].squaredNorm()) * step_.to->area[f];
    }
  mark(step_.end());
  scene_.obstacles->begin(step_, from, prediction_.w);
  if (heat_) heat_->advance(from);
  predict_from_guess(from);
  projection_.prepare(from);
}

template <int D>
void FractionalStep<D>::predict_heat(const State<D>& from, const FlowHistory<D>& by, SubStep<D> step) {
  step_ = {std::move(step), by};
  heat_->advance(from);
}

template <int D>
void FractionalStep<D>::commit_heat(State<D>& s) {
  heat_->commit(s);
  s.time = step_.end();
  s.dt_old = step_.dt;
}

template <int D>
void FractionalStep<D>::predict_from_guess(const State<D>& from) {
  Vectors<D> turned, at_boundary = from.u_boundary;
  if (scene_.parameters.rotating_frame) {
    turned = from.u;
    const double ratio = step_.ratio();
    for (std::size_t c = 0; ratio > 0 && c < turned.size(); ++c)
      turned[c] += 0.5 * ratio * (from.u[c] - from.u_old[c]);
    for (std::size_t b = 0; ratio > 0 && b < at_boundary.size(); ++b)
      at_boundary[b] += 0.5 * ratio * (from.u_boundary[b] - from.u_boundary_old[b]);
    turned = projection_.adjoint(*step_.to, turned, at_boundary);
  }
  predictor_.predict(from, turned);
  mesh_.cells.update_ghosts(flat<D>(prediction_.u), D);
  scene_.obstacles->hold(*step_.to, step_.dt, prediction_.u);
  flux_.predict(from, prediction_.u);
}

template <int D>
void FractionalStep<D>::project(const State<D>& from, const Vectors<D>& w, double answer) {
  level_.reset();
  projection_.project(from, w, flux_.phi(), answer);
  loads_.set(scene_, step_, prediction_, projected_, from);
}

template <int D>
void FractionalStep<D>::mark_level(State<D>& s) {
  step_.to = s.placement;
  step_.points = s.points;
  step_.swept.clear();
  mark(s.time);
  s.blocked = scene_.obstacles->marks();
}

/// u = u0 - grad psi with divergence-free phi: the same equation with dt = 1 s, rho = 1. If the given wall
/// velocity differs from u0 at the wall (an impulsively started inlet), the field becomes the potential flow.
template <int D>
void FractionalStep<D>::project_initial(State<D>& s) {
  scene_.oblique = parallel::max(mesh_.comm, s.placement->obliqueness) > orthogonal ||
                   (!s.points.empty() && !s.placement->shape);
  const Placement<D>& at = *s.placement;
  for (const auto& force : scene_.forces) force->start(at);
  projected_.phi.assign(mesh_.n_flux_faces(), 0.0);
  step_ = {SubStep<D>{scene_.fluid.rho, s.placement, {}, s.points}, s};  // dt/rho = 1
  mark_level(s);
  scene_.obstacles->hold(at, step_.dt, s.u);
  mean_flux<D>(mesh_, at, scene_.flux_velocity(at, s.u), s.u_boundary, gradient_.values, projected_.phi);
  scene_.obstacles->carry(at, s.u, projected_.phi);
  for (std::size_t b = 0; b < s.w.size(); ++b)
    projected_.phi[mesh_.n_interior + b] = s.u_boundary[b].dot(at.area[mesh_.n_interior + b]);
  u_.resize(s.u.size());
  scene_.obstacles->block(step_, projected_.phi);
  projected_.w = s.w;
  projected_.gradient.clear();
  prediction_.u = s.u;
  projected_.p.assign(mesh_.cells.n_local(), 0.0);
  projected_.boundary.assign(s.w.size(), 0.0);
  projection_.start(at);
  if (pressure_is_state() && scene_.parameters.initial_pressure) return keep_initial(s);
  const Vectors<D> jump_from = s.u_boundary;
  projection_.set_boundary_flux(s.w);
  projection_.solve_initial(at);
  for (const Index b : scene_.boundary.rows().of_flux) {
    const Index f = mesh_.n_interior + b;
    projected_.boundary[b] =
        projected_.p[mesh_.owner[f]] - (s.w[b] - jump_from[b]).dot(at.area[f]) / at.conductance[f];
  }
  correct();
  s.phi.swap(projected_.phi);
  s.u.swap(u_);
  s.w = projected_.w;
  s.u_old.clear();
  s.pressure = {};
  scene_.boundary.close(mesh_, at, s.u, s.w, s.u_boundary);
  flux_.remember(s);
}

/// A compressible fluid may start from any velocity.
template <int D>
void FractionalStep<D>::keep_initial(State<D>& s) {
  for (const Index b : scene_.boundary.rows().of_flux) {
    const Index f = mesh_.n_interior + b;
    projected_.phi[f] = s.w[b].dot(s.placement->area[f]);
  }
  s.phi.swap(projected_.phi);
  projected_.phi.assign(s.phi.size(), 0.0);
  projection_.solve_initial(*s.placement);  // of nothing: the solver is there, as after any other start
  s.pressure = {};
  scene_.boundary.close(mesh_, *s.placement, s.u, s.w, s.u_boundary);
  flux_.remember(s);
}

/// Replaces phi^p by phi at t^{n+1}, which the next project() recomputes, and adds u beside u^p.
template <int D>
std::shared_ptr<PressureLevel<D>> FractionalStep<D>::correct() {
  const Placement<D>& now = *step_.to;
  const std::vector<double>& conductance = scene_.around(step_).conductance;
  const double factor = step_.dt / scene_.fluid.rho;
  const FluxCorrection correction{factor, conductance.data(), projected_.phi.data()};
  for (const Index b : scene_.boundary.rows().of_pressure) {
    const Index f = mesh_.n_interior + b;
    projected_.phi[f] -= factor * conductance[f] * (projected_.boundary[b] - projected_.p[mesh_.owner[f]]);
  }
  auto level = projection_.pressure_level(&correction);
  Vectors<D>& u = u_;
  u.resize(prediction_.u.size());
  velocity_pass(flat<D>(prediction_.u), factor, flat<D>(level->gradient),
                flat<D>(u).first(std::size_t(mesh_.cells.n_owned()) * D));
  mesh_.cells.update_ghosts(flat<D>(u), D);
  scene_.obstacles->hold(now, step_.dt, u);
  return level;
}

template <int D>
void FractionalStep<D>::complete(const State<D>& from, const Vectors<D>& w) {
  if (level_) return;
  level_ = correct();
  solve_coupled(from, w);
  judgement_ = evaluate(from);
  check(from);
}

template <int D>
void FractionalStep<D>::commit(State<D>& s) {
  if (!level_) {
    level_ = correct();
    judgement_ = evaluate(s);
  }
  s.largest_speed = std::max(s.largest_speed, judgement_.speed);
  s.ledger = judgement_.energy.ledger;
  static_cast<FlowHistory<D>&>(s) = step_.by;
  for (const auto& term : projection_.terms()) term->commit(projected_, s);
  s.phi.swap(projected_.phi);
  if (scene_.parameters.courant) s.phi_old = projected_.phi;
  s.u_old.swap(s.u);
  s.u.swap(u_);
  s.number = ++states_;
  s.pressure = {std::move(level_), s.pressure[0], s.pressure[1]};
  const std::size_t with_gradient = scene_.oblique ? 2 : 1;
  if (auto& last = s.pressure[with_gradient]; last && !last->gradient.empty())
    last = std::make_shared<PressureLevel<D>>(
        PressureLevel<D>{last->time, last->p, last->boundary, {}, last->ends, {}, {}});
  s.u_boundary_old.swap(s.u_boundary);
  s.w = projected_.w;
  scene_.boundary.close(mesh_, *step_.to, s.u, s.w, s.u_boundary);
  flux_.remember(s);
  if (!projected_.rotational.empty()) {
    auto whole = std::make_shared<PressureLevel<D>>(*s.pressure[0]);
    projection_.add_rotational(*whole);
    s.pressure[0] = std::move(whole);
  }
  s.rates_old.rate.swap(prediction_.rates.rate);
  s.rates_old.viscous.swap(prediction_.rates.viscous);
  s.shear_old.swap(prediction_.shear);
  s.placement = step_.to;
  s.blocked = scene_.obstacles->marks();
  s.points.swap(step_.points);
  if (heat_) heat_->commit(s);
  s.mesh_flux.swap(step_.swept);
  for (double& flux : s.mesh_flux) flux /= step_.dt;
  s.dt_old = step_.dt;
  s.time += step_.dt;
  if (s.start == Start::at_rest || scene_.obstacles->starts_anew()) {
    // The multi-step schemes begin after the impulse.
    s.start = Start::after_impulse;
    s.dt_old = 0;
  }
  start_momentum(s);
}

template <int D>
EnergyStep<D> FractionalStep<D>::energy_step(const State<D>& from) const {
  return {from,
          *step_.to,
          step_.dt,
          u_,
          projected_.w,
          projected_.phi,
          projected_.boundary,
          step_.swept,
          prediction_.force,
          prediction_.viscous_flux,
          *level_};
}

template <int D>
typename FractionalStep<D>::Outcome FractionalStep<D>::evaluate(const State<D>& from) const {
  const double fastest = largest_square<D>({u_.data(), std::size_t(mesh_.cells.n_owned())});
  double given = 0;
  for (const Vec<D>& w : projected_.w) given = std::max(given, w.squaredNorm());
  double largest[2] = {fastest, given};
  MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, mesh_.comm);
  Outcome j;
  j.energy = energy_check_.evaluate(energy_step(from));
  j.speed = std::sqrt(largest[0]);
  j.given_speed = std::sqrt(largest[1]);
  return j;
}

/// True if the flow is much faster than all previous and given speeds, and crosses a cell in the step. Motion
/// starting in a fluid at rest except for round-off is no divergence.
template <int D>
bool FractionalStep<D>::too_fast(double so_far) const {
  if (!(so_far > 0) || !(judgement_.speed > explosion * std::max(so_far, judgement_.given_speed)))
    return false;
  bool crosses = false;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    crosses |= !(std::pow(u_[c].norm() * step_.dt, D) <= step_.to->volume[c]);
  return parallel::any(mesh_.comm, crosses);
}

/// Finds the location of a failure: the fastest cell if out of bounds, else the one that gained most energy.
template <int D>
void FractionalStep<D>::check(const State<D>& from) {
  const bool finite = std::isfinite(judgement_.speed);
  const bool fast = too_fast(from.largest_speed);
  const bool created = judgement_.energy.out_of_bounds && scene_.obstacles->is_in_budget();
  if (finite && !fast && !created) return;
  const LargestCell worst = find_largest(mesh_, *step_.to, [&](Index c) {
    const double square = u_[c].squaredNorm();
    if (finite && !fast)
      return step_.to->volume[c] * square - from.placement->volume[c] * from.u[c].squaredNorm();
    return std::isfinite(square) ? square : std::numeric_limits<double>::max();
  });
  std::string cause;
  if (worst.here >= 0)
    cause = likely_cause(mesh_, scene_.boundary, energy_step(from), worst.here, scene_.fluid.nu,
                         step_.by.implicit);
  parallel::broadcast(mesh_.comm, cause, worst.rank);
  if (const std::string shut = scene_.obstacles->cause(*step_.to); !shut.empty()) cause = shut;
  const EnergyChange& e = judgement_.energy;
  const std::string what =
      !finite ? "its velocity is not finite"
      : fast  ? fmt::format("its velocity grew to {:.3g} m/s", judgement_.speed)
              : fmt::format(
                    "its kinetic energy grew by {:.3g} J to {:.3g} J in one step, of which boundaries and "
                     "forces supplied {:.3g} J",
                    e.gain, e.ledger.energy, e.work);
  throw SolveFailure(
      "The flow diverges at t = {:.6g} s: {}, mostly in cell {} at ({:.6g}, {:.6g}, {:.6g}) m.{}{}",
      step_.end(), what, worst.id, worst.place.x(), worst.place.y(), worst.place.z(),
      cause.empty() ? "" : " ", cause);
}

template class FractionalStep<2>;
template class FractionalStep<3>;

}  // namespace couplet::fluid
