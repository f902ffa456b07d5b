// SPDX-License-Identifier: Apache-2.0
// One stage of a step: system, right-hand side and solution (equations: SolidStepper).
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/method_choice.hpp"
#include "solid_solver/equilibrium/load_path.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {
namespace {

// Number of systems kept for other step sizes, because a halved step soon returns to its length.
constexpr std::size_t systems_kept = 2;

/// Estimate of the highest natural frequency [rad/s], 2 sqrt(E/rho)/L with the distance L of two neighboring
/// nodes: equations (2.41) and (2.42) of [thesis]. Collective.
double highest_frequency(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                         const elastic::ElasticOperator& elastic, const SolidBody& body) {
  double highest = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index cell = mesh.owner[f];
    const Vec3& other =
        f < mesh.n_interior ? geometry.cell_centre[mesh.neighbour[f]] : geometry.face_centre[f];
    const double length = (other - geometry.cell_centre[cell]).norm();
    const auto [mu, lambda] = elastic.lame(cell);
    const double youngs_modulus = mu * (3 * lambda + 2 * mu) / (lambda + mu);
    highest = std::max(highest, 2 / length * std::sqrt(youngs_modulus / body.density(cell)));
  }
  return parallel::max(mesh.comm, highest);
}

/// Linear combinations of time levels per component of cells or faces. `start`: state at the start of the
/// step, which is the old level of a second stage.
class History {
 public:
  History(const SolidState& now, const SolidState& start, bool of_faces)
      : u_(of_faces ? now.face_u : now.cell_u),
        v_(of_faces ? now.face_v : now.cell_v),
        a_(of_faces ? now.face_a : now.cell_a),
        u_old_(&now == &start ? (of_faces ? now.face_u_old : now.cell_u_old)
                              : (of_faces ? start.face_u : start.cell_u)),
        v_old_(&now == &start ? (of_faces ? now.face_v_old : now.cell_v_old)
                              : (of_faces ? start.face_v : start.cell_v)) {}
  double operator()(const time::Levels& l, std::size_t i, double x = 0) const {
    double value = l.x * x + l.u * u_[i] + l.v * v_[i];
    if (!a_.empty()) value += l.a * a_[i];
    if (!u_old_.empty()) value += l.u_old * u_old_[i] + l.v_old * v_old_[i];
    return value;
  }

 private:
  std::span<const double> u_, v_, a_, u_old_, v_old_;
};

/// Such a combination for all unknowns.
std::vector<double> levels_of(const SolidBody& body, const SolidState& now, const SolidState& start,
                              const time::Levels& levels) {
  std::vector<double> cells(now.cell_u.size()), faces(now.face_u.size());
  const History of_cells(now, start, false), of_faces(now, start, true);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = of_cells(levels, i);
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = of_faces(levels, i);
  return body.unknowns_of(cells, faces);
}

/// Levels of the part of a displacement that is independent of w, from levels `shown` of x = (w - beta v_h)/s.
time::Levels known_part(const SolidBody& body, const StageWork& work, const time::Levels& shown) {
  const double beta = body.parameters().damping ? body.parameters().damping->stiffness : 0;
  return time::Levels{0, shown.u, shown.v, shown.a, shown.u_old, shown.v_old} -
         (shown.x * beta / work.damping_scale) * work.stage.rate;
}

/// Response of the seat to the unknown w = x + beta v of a stage. The conserving rule uses the penetration at
/// the end of the step, other schemes that at the stage's equilibrium. `now`: start of the stage, `start`:
/// start of the step. Empty without a seat. Collective.
std::optional<Pressing> pressing_of(const SolidBody& body, const StageWork& work, const SolidState& now,
                                    const SolidState& start) {
  const Seat* seat = body.seat();
  if (!seat) return {};
  const std::size_t n_known = body.prescribed().size() * body.mesh().dim;
  std::vector<double> known_before(n_known, 0), known_shown(n_known, 0);
  if (!body.is_dynamic()) {
    const std::vector<double> still(body.elastic().n_unknowns(), 0);
    return Pressing(*seat, 1, seat->penetration(still, {}), {});
  }
  const bool conserves = seat->is_conserving();
  const time::Levels shown = conserves ? work.stage.end_value : time::Levels{1, 0, 0, 0, 0, 0};
  const double factor = shown.x / work.damping_scale;
  if (!body.prescribed().is_zero()) {
    body.prescribed().evaluate(work.start_time, known_before);
    body.prescribed().evaluate(work.end_time, known_shown);
    const double place = conserves ? 1 : work.stage.place;
    for (std::size_t i = 0; i < n_known; ++i)
      known_shown[i] = known_before[i] + place * (known_shown[i] - known_before[i]) - factor * work.known[i];
  }
  std::vector<double> base = seat->penetration(levels_of(body, now, start, known_part(body, work, shown)),
                                               known_shown),
                      before;
  if (conserves) before = seat->penetration(body.unknowns_of(now.cell_u, now.face_u), known_before);
  return Pressing(*seat, factor, std::move(base), std::move(before));
}

}  // namespace

std::vector<time::Stage> SolidStepper::stages_of(double dt) const {
  if (body_.is_dynamic())
    return time::second_order_stages(scheme_of(parameters_), dt, {state_.steps, state_.dt});
  // No inertia or damping; velocities are differences.
  time::Stage still{.dt = dt};
  still.end_value.x = 1;
  still.end_rate.x = 1 / dt;
  still.end_rate.u = -1 / dt;
  return {still};
}

SolidSystem& SolidStepper::system_for(double mass_factor) {
  const auto same = [&](const std::unique_ptr<SolidSystem>& s) {
    return std::abs(s->mass_factor - mass_factor) <= 1e-10 * mass_factor;
  };
  const auto found = std::ranges::find_if(systems_, same);
  if (found != systems_.end()) {
    std::rotate(systems_.begin(), found, found + 1);
    return *systems_.front();
  }
  if (systems_.size() == systems_kept) systems_.pop_back();
  auto system = std::make_unique<SolidSystem>();
  system->mass_factor = mass_factor;
  if (mass_factor > 0)
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      system->inertia.push_back(mass_factor * body_.density(c) * geometry_.volume[c]);
  const SolidProblem problem = problem_of(*system);
  if (!body_.large_strain())
    system->method = make_solution_method(problem, parameters_.method);
  else if (body_.finite_strain())
    system->node_inertia = node_inertia(problem);
  announce(*system);
  systems_.insert(systems_.begin(), std::move(system));
  return *systems_.front();
}

SolidProblem SolidStepper::problem_of(const SolidSystem& system) const {
  SolidProblem problem{mesh_, elastic_, system.inertia, kernel_, body_.has_mass() ? system.mass_factor : 0};
  if (const RigidPatches& rigid = body_.rigid(); !rigid.empty())
    problem.project = [&rigid](std::span<double> unknowns) { rigid.project(unknowns); };
  return problem;
}

void SolidStepper::announce(const SolidSystem& system) {
  const std::string chosen = body_.large_strain() ? body_.large_strain()->name() : system.method->name();
  if (chosen == method_announced_) return;
  const bool first = method_announced_.empty();
  method_announced_ = chosen;
  log::info("Solution method: {}", chosen);
  if (first && body_.is_dynamic() && parameters_.output.modes == 0)
    log::info(
        "elastic Courant number of a step of {:.3g} s: {:.3g} (an explicit scheme would need at most 1)",
        step_.dt, step_.dt * highest_frequency(mesh_, geometry_, elastic_, body_) / 2);
}

void SolidStepper::prepare_stage(StageWork& work) {
  const time::Stage& stage = work.stage;
  const SolidDamping damping = parameters_.damping.value_or(SolidDamping{});
  work.start_time = step_.time + stage.start;
  work.place_time = work.start_time + stage.place * stage.dt;
  work.end_time = work.start_time + stage.dt;
  work.damping_scale = 1 + damping.stiffness * stage.rate.x;
  work.system = &system_for((stage.acceleration.x + damping.mass * stage.rate.x) / work.damping_scale);
  const bool is_loaded = body_.has_body_forces() || body_.thermal() || !body_.prescribed().is_zero() ||
                         parameters_.output.energies;
  work.known_force.clear();
  work.rhs.assign(is_loaded ? elastic_.n_unknowns() : 0, 0);
  work.face_force = body_.dead_loads(work.place_time);
  add_body_forces(work.place_time, work.rhs);
  if (body_.thermal()) body_.thermal()->add_loads(work.place_time, kernel_, work.rhs);
  if (parameters_.output.energies) {
    work.loads = work.rhs;
    work.known.assign(trial_.known.size(), 0);
    work.known_change = work.known;
  }
  if (!body_.prescribed().is_zero()) subtract_prescribed(work);
}

// Known w = x + beta v: interpolated between the ends as in the cells.
void SolidStepper::subtract_prescribed(StageWork& work) {
  const double place = work.stage.place, beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  std::vector<double> start(trial_.known.size());
  work.known.resize(trial_.known.size());
  body_.prescribed().evaluate(work.start_time, start);
  body_.prescribed().evaluate(work.end_time, work.known);
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double change = work.known[i] - start[i];
    if (!work.known_change.empty()) work.known_change[i] = change;
    work.known[i] = start[i] + (place + beta / work.stage.dt) * change;
  }
  if (body_.large_strain()) return;  // find() moves the known columns
  const std::vector<double> still(elastic_.n_unknowns(), 0);
  std::vector<double> force = body_.equilibrium().forces(still, work.known);
  for (std::size_t i = 0; i < force.size(); ++i) work.rhs[i] -= force[i];
  work.known_force = std::move(force);
}

void SolidStepper::add_body_forces(double t, std::span<double> rhs) {
  const std::vector<double> forces = body_.body_forces(t);
  if (forces.empty()) return;
  kernel_.add_cell_forces(forces, rhs);
  last_.body_force.setZero();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Vec3& centre = geometry_.cell_centre[i / std::size_t(mesh_.dim)];
    const double ring = is_axisymmetric(elastic_) ? elastic::circumference(centre[0]) : 1;
    last_.body_force[Index(i % mesh_.dim)] += ring * forces[i];
  }
}

void SolidStepper::solve_stage(const StageWork& work, bool first) {
  const SolidState& now = first ? state_ : trial_;
  if (work.rhs.empty())
    last_.rhs.assign(last_.unknowns.size(), 0);
  else
    last_.rhs = work.rhs;
  if (work.system->mass_factor > 0 && !body_.has_mass()) add_inertia(work, now);
  add_face_forces(work);
  if (body_.has_mass()) {
    last_.load_rows = last_.rhs;
    if (!work.known_force.empty())
      for (std::size_t i = 0; i < last_.rhs.size(); ++i) last_.load_rows[i] += work.known_force[i];
    add_inertia(work, now);
  }
  guess(work, now);
  {
    const log::ScopedTimer timer(log::timers(), "solid: linear solver");
    const linalg::SolveStatistics statistics = find_equilibrium(work, now);
    effort_ = {effort_.solves + 1, effort_.iterations + statistics.iterations,
               effort_.inner_iterations + statistics.inner_iterations, statistics.residual};
  }
  if (first) trial_.energies = state_.energies, trial_.load_work = state_.load_work;
  if (first && state_.steps == 0 && body_.prescribed().uses_time())
    trial_.energies.initial_kinetic = ledger_.initial_kinetic(state_, step_.dt);
  // A second stage starts from the trial state, which will change.
  const bool keeps = body_.is_dynamic() && !first;
  const std::vector<double> cells = keeps ? now.cell_u : std::vector<double>();
  const std::vector<double> faces = keeps ? now.face_u : std::vector<double>();
  const BodyField start{first ? state_.cell_u : cells, first ? state_.face_u : faces, {}};
  const auto finish = [&] {
    finish_offsets(work.stage, now);
    finish_nodes(work, now);
    if (body_.is_dynamic()) ledger_.add_load_work(work, last_, start, trial_);
  };
  if (!parameters_.output.energies) return finish();
  const SolidState before = now;
  finish();
  ledger_.add_work({work, last_, before, trial_});
}

/// A static guess uses the previous known displacements; a dynamic one is extrapolated with its velocity.
linalg::SolveStatistics SolidStepper::find_equilibrium(const StageWork& work, const SolidState& now) {
  LoadPath* path = body_.load_path();
  if (path) body_.set_load_factor(1);
  body_.place_pressures(work.place_time);
  body_.place_expansion(work.place_time);
  if (path) body_.set_load_factor(path->factor());
  EquilibriumLoad load{last_.rhs, work.known, {}, work.system->mass_factor, parameters_.energy_momentum};
  std::optional<Pressing> pressing = pressing_of(body_, work, now, state_);
  load.pressing = pressing ? &*pressing : nullptr;
  if (!body_.is_dynamic() && !work.known.empty()) load.before = state_.known;
  const std::vector<double> accepted = body_.unknowns_of(state_.cell_u, state_.face_u);
  load.accepted = accepted;
  load.accepted_known = state_.known;
  load.inertia = work.system->inertia;
  load.node_inertia = work.system->node_inertia;
  load.dt = work.stage.dt;
  const linalg::SolveStatistics found = body_.equilibrium().find(load, *work.system, last_.unknowns);
  if (path) scale_loads(work, path->trial_factor());
  if (pressing) {  // from here on one more load
    last_.contact = pressing->forces();
    body_.seat()->add_to_rows(last_.contact, last_.rhs);
  }
  return found;
}

/// Scales the loads of the solve by a load factor.
void SolidStepper::scale_loads(const StageWork& work, double factor) {
  body_.set_load_factor(factor);
  for (double& v : last_.rhs) v *= factor;
  last_.body_force *= factor;
  last_.face_force *= factor;
  for (std::size_t i = 0; i < work.known.size(); ++i) trial_.known[i] = factor * work.known[i];
}

void SolidStepper::add_inertia(const StageWork& work, const SolidState& now) {
  const time::Stage& stage = work.stage;
  const SolidDamping damping = parameters_.damping.value_or(SolidDamping{});
  time::Levels known =
      stage.acceleration + (damping.mass - work.system->mass_factor * damping.stiffness) * stage.rate;
  if (body_.has_mass()) {
    // All nodes have inertia. That of known ones acts on the supports only, since each node has a mass of its own.
    std::vector<double> force(last_.unknowns.size());
    kernel_.apply_with_mass(levels_of(body_, now, state_, known), {}, 1, false, force);
    for (std::size_t i = 0; i < force.size(); ++i) last_.rhs[i] -= force[i];
    return;
  }
  const History levels(now, state_, false);
  const int dim = mesh_.dim;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double mass = body_.density(c) * geometry_.volume[c];
    for (int a = 0; a < dim; ++a) {
      const std::size_t i = std::size_t(c) * dim + a;
      last_.rhs[i] -= mass * levels(known, i);
    }
  }
}

/// A partner's load is its mean over the step, valid at mid-step. It is extrapolated to the stage from the
/// last mid-step.
void SolidStepper::add_face_forces(const StageWork& work) {
  if (last_.interface.empty()) {
    last_.face_force = kernel_.add_face_forces(work.face_force, last_.rhs);
    return;
  }
  std::vector<double> force = work.face_force;
  for (std::size_t i = 0; i < last_.interface.size(); ++i) force[i] += last_.interface[i];
  if (const std::vector<double>& before = state_.interface; !before.empty() && state_.steps > 0) {
    const double on = (work.stage.place - 0.5) * work.stage.dt / (0.5 * (step_.dt + state_.dt));
    for (std::size_t i = 0; i < before.size(); ++i) force[i] += on * (last_.interface[i] - before[i]);
  }
  last_.face_force = kernel_.add_face_forces(force, last_.rhs);
}

// First guess of a stage and data from its solution (equations: SolidStepper).

// Guess for iterative methods from the accepted motion, so that equal loads give equal results. Thesis
// (2.73): u^n + a v^n, with a the time to the place of the stage. The guess (2.74) from two velocities took
// 0.9 to 1.6 times as many iterations on the cantilever of case C.
void SolidStepper::guess(const StageWork& work, const SolidState& now) {
  using Predictor = MethodParameters::Predictor;
  const Predictor predictor = parameters_.method.predictor;
  const double ahead =
      body_.is_dynamic() && predictor != Predictor::none ? work.stage.place * work.stage.dt : 0;
  last_.unknowns = levels_of(body_, now, state_, {0, 1, ahead, 0, 0, 0});
}

/// Faces with inertia are like the cells, and known support values are imposed at the end of the step; others have an offset.
void SolidStepper::finish_nodes(const StageWork& work, const SolidState& now) {
  const time::Stage& stage = work.stage;
  const double s = work.damping_scale, beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  const auto finish = [&](const History& levels, std::size_t i, double w, std::vector<double>& u,
                          std::vector<double>& v, std::vector<double>& a) {
    const double x = beta > 0 ? (w - beta * levels(stage.rate, i)) / s : w;
    const double end = levels(stage.end_value, i, x), rate = levels(stage.end_rate, i, x);
    if (!a.empty()) a[i] = levels(stage.end_acceleration, i, x);
    u[i] = end;
    v[i] = rate;
  };
  const History of_cells(now, state_, false), of_faces(now, state_, true);
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < n_cells; ++i)
    finish(of_cells, i, last_.unknowns[i], trial_.cell_u, trial_.cell_v, trial_.cell_a);
  trial_.stage_dt = stage.dt;
  std::size_t row = n_cells;
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a, ++row) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[f]) * dim + a;
      if (body_.has_mass()) {
        finish(of_faces, b, last_.unknowns[row], trial_.face_u, trial_.face_v, trial_.face_a);
      } else {
        trial_.face_u[b] += trial_.cell_u[c];
        trial_.face_v[b] += trial_.cell_v[c];
      }
    }
}

// Stores in the faces the offset that finish_nodes() adds to cell values: delta = u_B - u_P at the end of the
// stage, extrapolated from this solve and the last one (trapezoidal rule with equal steps: 3/2 and -1/2). Its
// rate, valid at mid-step, follows from the ends. With stiffness damping w leads: w_B - w_P = delta + beta
// d(delta)/dt.
void SolidStepper::finish_offsets(const time::Stage& stage, const SolidState& now) {
  if (body_.has_mass()) return;
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  const bool is_first = now.stage_dt == 0;
  const double lag = (1 - stage.place) * stage.dt, gap = now.offset_lag + stage.place * stage.dt;
  const double slope = is_first ? 0 : lag / gap;
  const double rate_slope = is_first || !body_.is_dynamic() ? 0 : stage.dt / (stage.dt + now.stage_dt);
  const double relax = (parameters_.damping ? parameters_.damping->stiffness : 0) / gap;
  const auto& faces = elastic_.unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(faces[i] - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[faces[i]]) * dim + a;
      const double here =
          (last_.unknowns[n_cells + i * dim + a] - last_.unknowns[c] + relax * now.offset[b]) / (1 + relax);
      const double end = here + slope * (here - now.offset[b]);
      const double rate = (end - (now.face_u[b] - now.cell_u[c])) / stage.dt;
      const double end_rate = rate + rate_slope * (rate - now.offset_rate[b]);
      trial_.offset[b] = here;
      trial_.offset_rate[b] = rate;
      trial_.face_u[b] = end;
      trial_.face_v[b] = end_rate;
    }
  trial_.offset_lag = lag;
}

// The mean over a step is valid at mid-step in every scheme; at n+1 it is extrapolated from the last two.
// Traction faces use that of their cell and the change of their offset's rate.
void SolidStepper::finish_acceleration() {
  const double dt = step_.dt, slope = state_.steps > 0 ? dt / (dt + state_.dt) : 0;
  for (std::size_t i = 0; i < trial_.acceleration.size(); ++i) {
    const double mean = (trial_.cell_v[i] - state_.cell_v[i]) / dt;
    trial_.mean_acceleration[i] = mean;
    trial_.acceleration[i] = mean + slope * (mean - state_.mean_acceleration[i]);
  }
  const int dim = mesh_.dim;
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[f]) * dim + a;
      // Faces with inertia: that of their cell plus the additional change of their own velocity.
      const double rate = trial_.face_v[b] - trial_.cell_v[c], before = state_.face_v[b] - state_.cell_v[c];
      trial_.face_acceleration[b] = trial_.acceleration[c] + (rate - before) / dt;
    }
  mesh_.cells.update_ghosts(trial_.acceleration, dim);
  mesh_.boundary.update_ghosts(trial_.face_acceleration, dim);
  elastic_.join_twins(trial_.face_acceleration);
}

}  // namespace couplet::solid
