// SPDX-License-Identifier: Apache-2.0
// One stage of a step: the system, its right-hand side, and what follows from its solution (equations:
// Solid).
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/log/timer.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/newton_krylov.hpp"
#include "solid_solver/solid.hpp"
#include "solid_solver/system.hpp"

namespace couplet {
namespace {

// Systems of other step sizes that are kept: a step that was halved soon comes back to its length.
constexpr std::size_t systems_kept = 2;

/// Combinations of levels for one component after another.
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
  double operator()(const Levels& l, std::size_t i, double x = 0) const {
    double value = l.x * x + l.u * u_[i] + l.v * v_[i];
    if (!a_.empty()) value += l.a * a_[i];
    if (!u_old_.empty()) value += l.u_old * u_old_[i] + l.v_old * v_old_[i];
    return value;
  }

 private:
  std::span<const double> u_, v_, a_, u_old_, v_old_;
};

/// `start`: the state at the start of the step, which is the old level of a second stage.
History history(const SolidState& now, const SolidState& start) { return {now, start, false}; }

}  // namespace

std::vector<Stage> Solid::stages_of(double dt) const {
  if (is_dynamic()) return second_order_stages(parameters_.time_scheme, dt, {state_.steps, state_.dt});
  // No inertia, no damping; velocities are differences.
  Stage still{.dt = dt};
  still.end_value.x = 1;
  still.end_rate.x = 1 / dt;
  still.end_rate.u = -1 / dt;
  return {still};
}

Solid::System& Solid::system_for(double mass_factor) {
  const auto same = [&](const std::unique_ptr<System>& s) {
    return std::abs(s->mass_factor - mass_factor) <= 1e-10 * mass_factor;
  };
  const auto found = std::ranges::find_if(systems_, same);
  if (found != systems_.end()) {
    std::rotate(systems_.begin(), found, found + 1);
    return *systems_.front();
  }
  if (systems_.size() == systems_kept) systems_.pop_back();
  auto system = std::make_unique<System>();
  system->mass_factor = mass_factor;
  if (mass_factor > 0)
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      system->inertia.push_back(mass_factor * density(c) * mesh_.reference.volume[c]);
  if (finite_) {
    system->node_inertia = node_inertia(problem_of(*system));
  } else {
    system->method = make_solution_method(problem_of(*system), parameters_.method);
    elastic_.forget_faces();  // what the method needs of them it has by now
  }
  announce(*system);
  systems_.insert(systems_.begin(), std::move(system));
  return *systems_.front();
}

SolidProblem Solid::problem_of(const System& system) const {
  return {mesh_, elastic_, system.inertia, kernel_, has_mass_ ? system.mass_factor : 0};
}

void Solid::announce(const System& system) {
  const std::string chosen = finite_ ? finite_->name() : system.method->name();
  if (chosen == method_announced_) return;
  method_announced_ = chosen;
  log::info("Solution method: {}", chosen);
}

void Solid::prepare_stage(StageWork& work) {
  const Stage& stage = work.stage;
  const SolidDamping damping = parameters_.damping.value_or(SolidDamping{});
  work.start_time = step_.time + stage.start;
  work.place_time = work.start_time + stage.place * stage.dt;
  work.end_time = work.start_time + stage.dt;
  work.damping_scale = 1 + damping.stiffness * stage.rate.x;
  work.system = &system_for((stage.acceleration.x + damping.mass * stage.rate.x) / work.damping_scale);
  const bool is_loaded = !body_force_.empty() || !parameters_.gravity.empty() || !effects_.empty() ||
                         !prescribed_.is_zero() || parameters_.output.energies;
  work.known_force.clear();
  work.rhs.assign(is_loaded ? elastic_.n_unknowns() : 0, 0);
  work.face_force.assign(std::size_t(mesh_.boundary.n_owned()) * mesh_.dim, 0);
  add_body_forces(work.place_time, work.rhs);
  for (const auto& effect : effects_) effect->add_loads(work.place_time, kernel_, work.rhs);
  boundaries_.add_forces(work.place_time, work.face_force, !finite_);
  if (parameters_.output.energies) {
    work.loads = work.rhs;
    work.known.assign(known_.size(), 0);
    work.known_change = work.known;
  }
  if (!prescribed_.is_zero()) subtract_prescribed(work);
}

// Known w = x + beta v: the value between the ends is the same mean of them as in the cells.
void Solid::subtract_prescribed(StageWork& work) {
  const double place = work.stage.place, beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  std::vector<double> start(known_.size());
  work.known.resize(known_.size());
  prescribed_.evaluate(work.start_time, start);
  prescribed_.evaluate(work.end_time, work.known);
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double change = work.known[i] - start[i];
    if (!work.known_change.empty()) work.known_change[i] = change;
    work.known[i] = start[i] + (place + beta / work.stage.dt) * change;
  }
  if (finite_) return;  // it takes the known values themselves
  std::vector<double> still(work.rhs.size(), 0), force(work.rhs.size());
  kernel_.apply(still, work.known, force);
  for (std::size_t i = 0; i < force.size(); ++i) work.rhs[i] -= force[i];
  work.known_force = std::move(force);
}

void Solid::add_body_forces(double t, std::span<double> rhs) {
  const std::vector<double> forces = body_forces(t);
  if (forces.empty()) return;
  kernel_.add_cell_forces(forces, rhs);
  body_load_.setZero();
  for (std::size_t i = 0; i < forces.size(); ++i) body_load_[Index(i % mesh_.dim)] += forces[i];
}

/// Of the owned cells [N], `dim` values each; empty: none.
std::vector<double> Solid::body_forces(double t) const {
  if (body_force_.empty() && parameters_.gravity.empty()) return {};
  const int dim = mesh_.dim;
  std::vector<double> forces(std::size_t(mesh_.cells.n_owned()) * dim);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int a = 0; a < dim; ++a) {
      double force = body_force_.empty() ? 0 : body_force_[a](mesh_.reference.cell_centre[c], t);
      if (!parameters_.gravity.empty()) force += density(c) * parameters_.gravity[a];
      forces[std::size_t(c) * dim + a] = force * mesh_.reference.volume[c];  // (2.59)
    }
  return forces;
}

/// Sum of the given forces, `dim` values a boundary face of owned cells; empty without interface.
std::vector<double> Solid::interface_load(const Exchange& in) const {
  if (!interface_) return {};
  const int dim = mesh_.dim;
  std::vector<double> total(description_.face_centres.size() * dim, 0.0);
  for (const auto& [name, values] : in) {
    if (name == "temperature" && interface_temperature_) continue;
    if (std::ranges::none_of(description_.takes, [&](const auto& datum) { return datum.name == name; }))
      throw Error("The solid was given '{}', which it does not take.", name);
    if (name == "pressure" && values.size() * dim == total.size()) {
      // A normal force on each face; the areas point out of the solid.
      for (std::size_t i = 0; i < values.size(); ++i)
        for (int a = 0; a < dim; ++a) total[i * dim + a] -= values[i] * description_.face_areas[i][a];
      continue;
    }
    if (values.size() != total.size())
      throw Error("The solid was given {} values of '{}'; its interface has {} faces of {} components.",
                  values.size(), name, description_.face_centres.size(), dim);
    for (std::size_t i = 0; i < values.size(); ++i) total[i] += values[i];
  }
  std::vector<double> force(std::size_t(mesh_.boundary.n_owned()) * dim, 0);
  const std::vector<double> local = interface_->scatter_faces(total, dim);
  for (std::size_t i = 0; i < interface_->faces().size(); ++i)
    for (int a = 0; a < dim; ++a)
      force[std::size_t(interface_->faces()[i] - mesh_.n_interior) * dim + a] += local[i * dim + a];
  return force;
}

void Solid::solve_stage(const StageWork& work, std::span<const double> interface_load, bool first) {
  const SolidState& now = first ? state_ : trial_;
  if (work.rhs.empty())
    std::ranges::fill(rhs_, 0.0);
  else
    rhs_ = work.rhs;
  if (work.system->mass_factor > 0 && !has_mass_) add_inertia(work, now);
  add_face_forces(work, interface_load);
  if (has_mass_) {
    load_rows_ = rhs_;
    if (!work.known_force.empty())
      for (std::size_t i = 0; i < rhs_.size(); ++i) load_rows_[i] += work.known_force[i];
    add_inertia(work, now);
  }
  guess(work, now);
  {
    const log::ScopedTimer timer(log::timers(), "solid: linear solver");
    const SolveStatistics statistics =
        finite_ ? solve_finite(work) : work.system->method->solve(rhs_, unknowns_);
    effort_ = {effort_.solves + 1, effort_.iterations + statistics.iterations,
               effort_.inner_iterations + statistics.inner_iterations, statistics.residual};
  }
  if (first) trial_.energies = state_.energies, trial_.load_work = state_.load_work;
  // A second stage starts from the trial state, which is about to change.
  const bool keeps = is_dynamic() && !first;
  const std::vector<double> cells = keeps ? now.cell_u : std::vector<double>();
  const std::vector<double> faces = keeps ? now.face_u : std::vector<double>();
  const auto finish = [&] {
    finish_offsets(work.stage, now);
    finish_cells(work, now);
    if (is_dynamic())
      add_load_work(work, interface_load, first ? state_.cell_u : cells, first ? state_.face_u : faces);
  };
  if (!parameters_.output.energies) return finish();
  const SolidState before = now;
  finish();
  if (has_mass_)
    add_symmetric_work(work, before);
  else
    add_work(work, before);
}

/// A static guess stands where the known displacements were; a dynamic one has gone on with its own velocity.
SolveStatistics Solid::solve_finite(const StageWork& work) {
  finite_->kernel().set_pressure(boundaries_.pressures(work.place_time));
  if (parameters_.energy_momentum)
    finite_->kernel().set_start(unknowns_of(state_.cell_u, state_.face_u), known_accepted_);
  FiniteStrain::Load load{rhs_, work.known, {}, work.system->mass_factor, parameters_.energy_momentum};
  if (!is_dynamic() && !work.known.empty()) load.before = known_accepted_;
  const std::vector<double> accepted = unknowns_of(state_.cell_u, state_.face_u);
  load.accepted = accepted;
  load.accepted_known = known_accepted_;
  const SolveStatistics statistics = finite_->solve(load, work.system->node_inertia, unknowns_);
  finite_->kernel().forget_start();
  return statistics;
}

void Solid::add_inertia(const StageWork& work, const SolidState& now) {
  const Stage& stage = work.stage;
  const SolidDamping damping = parameters_.damping.value_or(SolidDamping{});
  Levels known =
      stage.acceleration + (damping.mass - work.system->mass_factor * damping.stiffness) * stage.rate;
  if (has_mass_) return add_kernel_inertia(work, now, known);
  const History levels = history(now, state_);
  const int dim = mesh_.dim;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double mass = density(c) * mesh_.reference.volume[c];
    for (int a = 0; a < dim; ++a) {
      const std::size_t i = std::size_t(c) * dim + a;
      rhs_[i] -= mass * levels(known, i);
    }
  }
}

/// All nodes have inertia, known ones that of their own acceleration (and mass damping of their velocity).
void Solid::add_kernel_inertia(const StageWork& work, const SolidState& now, const Levels& known) {
  const History cells(now, state_, false), faces(now, state_, true);
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  std::vector<double> levels(unknowns_.size()), force(unknowns_.size());
  for (std::size_t i = 0; i < n_cells; ++i) levels[i] = cells(known, i);
  const auto& open = elastic_.unknown_faces();
  for (std::size_t i = 0; i < open.size(); ++i)
    for (int a = 0; a < dim; ++a)
      levels[n_cells + i * dim + a] = faces(known, std::size_t(open[i] - mesh_.n_interior) * dim + a);
  const std::vector<double> of_known = known_inertia(work);
  kernel_.apply_with_mass(levels, of_known, 1, false, force);
  for (std::size_t i = 0; i < force.size(); ++i) rhs_[i] -= force[i];
}

/// Acceleration of the known columns at the place of a stage, with mass damping of their velocity; empty:
/// they rest.
std::vector<double> Solid::known_inertia(const StageWork& work) const {
  if (!prescribed_.uses_time()) return {};
  const double damping = parameters_.damping ? parameters_.damping->mass : 0, h = 0.5 * work.stage.dt;
  std::vector<double> before(known_.size()), now(before), after(before);
  prescribed_.evaluate(work.place_time - h, before);
  prescribed_.evaluate(work.place_time, now);
  prescribed_.evaluate(work.place_time + h, after);
  for (std::size_t i = 0; i < now.size(); ++i)
    now[i] = (after[i] - 2 * now[i] + before[i]) / (h * h) + damping * (after[i] - before[i]) / (2 * h);
  return now;
}

void Solid::add_face_forces(const StageWork& work, std::span<const double> interface_load) {
  if (interface_load.empty()) {
    face_load_ = kernel_.add_face_forces(work.face_force, rhs_);
    return;
  }
  std::vector<double> force = work.face_force;
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += interface_load[i];
  face_load_ = kernel_.add_face_forces(force, rhs_);
}

// For iterative methods: where the accepted motion leads, so that equal loads give equal answers.
// Thesis (2.73): u^n + a v^n; (2.74): and a^2 / (2 dt^n) (v^n - v^{n-1}), a the way to the place of the
// stage.
void Solid::guess(const StageWork& work, const SolidState& now) {
  using Predictor = MethodParameters::Predictor;
  const Predictor predictor = parameters_.method.predictor;
  const double ahead = is_dynamic() && predictor != Predictor::none ? work.stage.place * work.stage.dt : 0;
  const bool adams = predictor == Predictor::adams && &now == &state_ && state_.steps > 0;
  const double bend = adams ? ahead * ahead / (2 * state_.dt) : 0;
  const auto curve = [&](std::size_t i) { return adams ? bend * (now.cell_v[i] - now.cell_v_old[i]) : 0.0; };
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < n_cells; ++i) unknowns_[i] = now.cell_u[i] + ahead * now.cell_v[i] + curve(i);
  const auto& faces = elastic_.unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(faces[i] - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[faces[i]]) * dim + a;
      unknowns_[n_cells + i * dim + a] = now.face_u[b] + ahead * now.face_v[b] + curve(c);
    }
}

void Solid::finish_cells(const StageWork& work, const SolidState& now) {
  const Stage& stage = work.stage;
  const double s = work.damping_scale, beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  const History levels = history(now, state_);
  const std::size_t n = std::size_t(mesh_.cells.n_owned()) * mesh_.dim;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = beta > 0 ? (unknowns_[i] - beta * levels(stage.rate, i)) / s : unknowns_[i];
    const double u = levels(stage.end_value, i, x), v = levels(stage.end_rate, i, x);
    if (!trial_.cell_a.empty()) trial_.cell_a[i] = levels(stage.end_acceleration, i, x);
    trial_.cell_u[i] = u;
    trial_.cell_v[i] = v;
  }
  trial_.stage_dt = stage.dt;
  if (has_mass_) return finish_faces(work, now);
  const int dim = mesh_.dim;
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[f]) * dim + a;
      trial_.face_u[b] += trial_.cell_u[c];
      trial_.face_v[b] += trial_.cell_v[c];
    }
}

/// As the cells, where faces have inertia. What a support knows is imposed at the end of the step.
void Solid::finish_faces(const StageWork& work, const SolidState& now) {
  const Stage& stage = work.stage;
  const double s = work.damping_scale, beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  const History levels(now, state_, true);
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  const auto& open = elastic_.unknown_faces();
  for (std::size_t i = 0; i < open.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(open[i] - mesh_.n_interior) * dim + a;
      const double w = unknowns_[n_cells + i * dim + a];
      const double x = beta > 0 ? (w - beta * levels(stage.rate, b)) / s : w;
      const double u = levels(stage.end_value, b, x), v = levels(stage.end_rate, b, x);
      if (!trial_.face_a.empty()) trial_.face_a[b] = levels(stage.end_acceleration, b, x);
      trial_.face_u[b] = u;
      trial_.face_v[b] = v;
    }
}

// Leaves in the faces what finish_cells() adds to their cells' values:
// delta = u_B - u_P at the end of the stage from the places of this solve and the last one (the trapezoidal
// rule with equal steps: 3/2 and -1/2), its rate likewise from the difference of the ends, which lives in the
// middle. Stiffness damping makes w of the solve lead: w_B - w_P = delta + beta d(delta)/dt.
void Solid::finish_offsets(const Stage& stage, const SolidState& now) {
  if (has_mass_) return;
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  const bool is_first = now.stage_dt == 0;
  const double lag = (1 - stage.place) * stage.dt, gap = now.offset_lag + stage.place * stage.dt;
  const double slope = is_first ? 0 : lag / gap;
  const double rate_slope = is_first || !is_dynamic() ? 0 : stage.dt / (stage.dt + now.stage_dt);
  const double relax = (parameters_.damping ? parameters_.damping->stiffness : 0) / gap;
  const auto& faces = elastic_.unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(faces[i] - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[faces[i]]) * dim + a;
      const double here =
          (unknowns_[n_cells + i * dim + a] - unknowns_[c] + relax * now.offset[b]) / (1 + relax);
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

}  // namespace couplet
