// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/fluid.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/motion/scene.hpp"

namespace couplet::fluid {
namespace {

// An interface diverges above this factor times all previous speeds, or initially this speed [m/s].
constexpr double most_times_faster = 1e4, most_speed = 1e8;

}  // namespace

template <int D>
Fluid<D>::Fluid(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters,
                bool moving_mesh, double start_time)
    : mesh_(mesh),
      parameters_(with_surfaces(parameters, moving_mesh)),
      path_(mesh, geometry, parameters_, moving_mesh),
      boundary_(mesh, geometry, parameters_),
      step_(mesh, path_.points_at_rest(), boundary_, parameters_, moving_mesh && !path_.translates()),
      sizes_(mesh, boundary_, parameters_, step_.momentum_terms()) {
  check_together(mesh_, boundary_, parameters_, moving_mesh);
  start(geometry, start_time);
}

template <int D>
void Fluid<D>::restore(State<D> state) {
  accepted_ = std::move(state);
  accepted_.number = 0;
  if (path_.translates()) accepted_.placement = path_.at(accepted_.points);
  split_ = false;
  step_.mark_level(accepted_);
  step_.start_momentum(accepted_);
}

template <int D>
void Fluid<D>::begin_step(double time, double dt) {
  rejected_ = time == time_ && dt < dt_;
  time_ = time;
  dt_ = dt;
  split_ = false;
  begin_ = accepted_;
  begin_.time = time;
  frozen_ = heat() && heat()->freezes_flow(time);
  statistics_.sub_steps = frozen_ ? 1 : 0;
  if (frozen_) return;
  double rate = 0;
  for (const auto& force : step_.scene().forces) rate = std::max(rate, force->rate(time, dt));
  if (const auto* heat = step_.heat()) rate = std::max(rate, heat->buoyancy_rate(accepted_));
  const std::optional<State<D>> moved = moved_by_boundaries();
  sizes_.begin_step(moved ? *moved : accepted_, time, dt, rate, moved.has_value(), begin_);
}

/// A fluid that no step has moved, as fast as its boundaries at the end of this one, for the size of its sub-steps; nothing
/// if it is about as fast already.
template <int D>
std::optional<State<D>> Fluid<D>::moved_by_boundaries() const {
  if (accepted_.largest_speed > 0) return {};
  State<D> moved = accepted_;
  boundary_.velocity_at(time_ + dt_, mesh_, *moved.placement, moved.w);
  double speed = 0, inside = 0;
  for (const Vec<D>& w : moved.w) speed = std::max(speed, w.norm());
  for (const Vec<D>& u : moved.u) inside = std::max(inside, u.norm());
  speed = parallel::max(mesh_.comm, speed), inside = parallel::max(mesh_.comm, inside);
  if (!(speed > 2 * inside) || speed > most_speed) return {};  // the step itself refuses what is faster
  for (std::size_t f = 0; f < moved.phi.size(); ++f) moved.phi[f] = speed * moved.placement->area[f].norm();
  for (std::size_t f = 0; f < moved.excess.size(); ++f) {  // of a fluid that thickens: sheared within a cell
    const double shear = speed * moved.placement->conductance[f] / moved.placement->area[f].norm();
    const double excess = parameters_.viscosity_at(shear) / parameters_.density - properties().nu;
    moved.excess[f] = std::max(moved.excess[f], excess);
  }
  return moved;
}

template <int D>
Vectors<D> Fluid<D>::wall_velocity_at(double done, const Vectors<D>& interface_velocity,
                                      const SubStep<D>& step) const {
  const double s = done / dt_;
  Vectors<D> w(accepted_.w.size(), Vec<D>::Zero());
  if (!interface_velocity.empty())
    for (std::size_t b = 0; b < w.size(); ++b)
      if (boundary_.is_interface(b)) w[b] = accepted_.w[b] + s * (interface_velocity[b] - accepted_.w[b]);
  boundary_.velocity_at(time_ + done, mesh_, *step.to, w);
  boundary_.convect(mesh_, *level().placement, level().u, level().w, step.dt, w);
  return w;
}

// The implicit predictor and the non-orthogonal part require the previous pressure. In the first step it
// comes from a trial of the step.
template <int D>
void Fluid<D>::start_pressure(const SubStep<D>& step, const Vectors<D>& w) {
  FlowHistory<D> probe = history_;
  probe.implicit = false;  // an implicit predictor without a pressure would smear what the pressure balances
  step_.predict(level(), probe, step, w);
  step_.project(level(), w);
  auto first = step_.pressure_level();
  first->time = history_.time;  // the step itself adds a level in its middle
  history_.pressure[0] = std::move(first);
}

template <int D>
void Fluid<D>::add_forces(double share) {
  pressure_force_ = pressure_done_;
  viscous_force_ = viscous_done_;
  for (std::size_t b = 0; b < pressure_force_.size(); ++b) {
    pressure_force_[b] += share * step_.pressure_force()[b];
    viscous_force_[b] += share * step_.viscous_force()[b];
  }
}

template <int D>
void Fluid<D>::prepare(std::span<const Vec3> points, const Vectors<D>& wall_velocity) {
  split_ = judged_ = false;
  history_ = begin_;
  if (heat()) heat()->begin(accepted_, dt_);
  if (frozen_)
    return step_.predict_heat(accepted_, history_, path_.sub_step(accepted_, dt_, 1, {}, {}, time_));
  statistics_.sub_steps = 0;
  path_.refuse_torn(points, time_ + dt_);
  pressure_done_.assign(accepted_.w.size(), Vec<D>::Zero());
  viscous_done_ = pressure_done_;
  double done = 0;
  for (bool last = false; !last;) {
    const double dt = sizes_.next(level(), history_.implicit, statistics_.sub_steps, dt_ - done, last);
    const double end = last ? dt_ : done + dt;
    SubStep<D> sub_step = path_.sub_step(level(), dt, end / dt_, accepted_.points, points, time_);
    sub_step.fast = sizes_.fast_cells(level(), history_.implicit, dt);
    last_w_ = wall_velocity_at(end, wall_velocity, sub_step);
    if (history_.start == Start::after_impulse) {
      if (!step_.pressure_is_state()) history_.pressure = {};
      history_.start = Start::flowing;
    }
    if ((history_.implicit || step_.oblique()) && !history_.pressure[0]) start_pressure(sub_step, last_w_);
    sub_step.yields = last && yields_;
    step_.predict(level(), history_, std::move(sub_step), last_w_);
    ++statistics_.sub_steps;
    ++statistics_.all_sub_steps;
    if (last) break;
    step_.project(level(), last_w_);
    step_.complete(level(), last_w_);
    add_forces(dt / dt_);
    pressure_done_.swap(pressure_force_);
    viscous_done_.swap(viscous_force_);
    if (!split_) trial_ = accepted_;
    split_ = true;
    if (parameters_.viscosity_law && boundary_.walls_turn()) {
      Vectors<D> turn = wall_turn(time_ + end);
      set_turn_of(trial_, turn);
    }
    step_.commit(trial_);
    history_ = trial_;
    done = end;
  }
  if (!boundary_.interface_patches().empty()) guess_ = last_w_;
}

template <int D>
void Fluid<D>::solve_pressure(const Vectors<D>& wall_velocity, double answer) {
  if (frozen_) return;
  if (!wall_velocity.empty())
    for (std::size_t b = 0; b < last_w_.size(); ++b)
      if (boundary_.is_interface(b)) last_w_[b] = wall_velocity[b];
  check_wall_velocity();
  step_.project(level(), last_w_, answer);
  // Once per prediction, because repetitions only change the potential flow of a bounded wall velocity.
  if (!judged_) step_.complete(level(), last_w_);
  judged_ = true;
  ++statistics_.pressure_solves;
  add_forces(step_.size() / dt_);
  add_turning();
}

template <int D>
void Fluid<D>::solve(std::span<const Vec3> points, const Vectors<D>& wall_velocity) {
  prepare(points, wall_velocity);
  solve_pressure(wall_velocity);
}

template <int D>
void Fluid<D>::accept() {
  if (frozen_) return step_.commit_heat(accepted_);
  if (split_) std::swap(accepted_, trial_);
  split_ = false;
  set_turn_of(accepted_, turn_);  // of the new level, which commit() reads
  accepted_.turns = boundary_.walls_turn();
  if (rejected_) accepted_.largest_speed = 0;
  step_.commit(accepted_);
  if (rejected_) accepted_.ledger.largest = std::max(0., accepted_.ledger.energy);
  step_.keep();
  accepted_.time = time_ + dt_;
  statistics_.pressure_iterations = step_.pressure_iterations();
  statistics_.viscous_iterations = step_.viscous_iterations();
}

template <int D>
void Fluid<D>::start(const mesh::Geometry& geometry, double time) {
  State<D>& s = accepted_;
  s.time = time;
  if (path_.moves()) s.points = geometry.points;
  s.placement = path_.start(geometry);
  if (parameters_.face_values != FaceValues::second_order) s.placement = step_.raise_order(s.placement);
  sizes_.set_fourth(step_.fourth() != nullptr);
  const Placement<D>& at = *s.placement;
  s.u.assign(mesh_.cells.n_local(), Vec<D>::Zero());
  s.w.assign(mesh_.boundary.n_owned(), Vec<D>::Zero());
  s.u_boundary = s.w;
  if (!parameters_.initial_velocity.empty()) {
    const auto expressions = fv::make_expressions(parameters_.initial_velocity, D, "initial-velocity");
    for (int c = 0; c < D; ++c) {
      expressions[c].evaluate(geometry.cell_centre, time, flat<D>(s.u), D, c);
      expressions[c].evaluate(at.boundary_centre, time, flat<D>(s.u_boundary), D, c);
    }
  }
  // Without an initial velocity, fluid and boundaries are at rest. Later boundary motion is an impulse in the
  // first step, which an elastic wall must feel. A given field is fitted to its boundaries instead.
  s.start = parameters_.initial_velocity.empty() ? Start::at_rest : Start::flowing;
  if (s.start == Start::flowing) {
    boundary_.velocity_at(time, mesh_, at, s.w);
    if (boundary_.walls_turn()) {
      s.turn.assign(s.w.size(), Vec<D>::Zero());
      boundary_.add_turn(mesh_, geometry.points, time, s.turn);
      s.turns = true;
    }
    if (parameters_.motion)
      set_body_start(mesh_, geometry.points, boundary_, *parameters_.motion, time, s.w, s.turn);
  }
  for (std::size_t b = 0; b < s.w.size(); ++b)
    if (boundary_.is_convective(b)) s.w[b] = s.u_boundary[b];
  for (const Index b : boundary_.rows().of_pressure) s.u_boundary[b] = s.u[mesh_.owner[mesh_.n_interior + b]];
  step_.project_initial(s);
  const fv::Expression initial_pressure(parameters_.initial_pressure.value_or(config::ExpressionText{}),
                                        "initial-pressure");
  if (step_.pressure_is_state() || !initial_pressure.is_zero()) {
    auto level = std::make_shared<PressureLevel<D>>();
    level->time = time;
    level->p.resize(mesh_.cells.n_local());
    level->boundary.resize(s.w.size());
    initial_pressure.evaluate(geometry.cell_centre, time, level->p);
    initial_pressure.evaluate(at.boundary_centre, time, level->boundary);
    if (s.start == Start::flowing && !parameters_.initial_pressure) {
      const double rest = boundary_.pressure_of_rest(time, at.boundary_centre);
      level->p.assign(level->p.size(), rest);
      level->boundary.assign(level->boundary.size(), rest);
    }
    step_.scene().add_potential(at, -properties().rho, *level);
    step_.start_level(at, *level);
    s.pressure[0] = level;
  }
  if (heat()) heat()->start(s);
  step_.start_terms(s);
  s.implicit = parameters_.viscous == ViscousTreatment::implicit;
  step_.start_momentum(s);
  step_.keep();
}

/// The layer dragged by a wall within a step is rho sqrt(nu dt) thick, a mass that acts on w* in the loop,
/// see docs/theory/coupling.md.
template <int D>
std::array<double, 2> Fluid<D>::unseen_share(const Vectors<D>& w) const {
  const auto [rho, mu, nu, sound] = properties();
  const std::vector<double>& excess = level().excess;
  double sums[4] = {};  // unseen^2, load^2, load.S, S^2
  for (std::size_t b = 0; b < guess_.size(); ++b) {
    if (!boundary_.is_interface(static_cast<Index>(b))) continue;
    const Vec<D>& area = level().placement->area[mesh_.n_interior + static_cast<Index>(b)];
    const Vec<D> load = pressure_force_[b] + viscous_force_[b];
    const double local = mu + (excess.empty() ? 0 : rho * excess[mesh_.n_interior + static_cast<Index>(b)]);
    const double layer = std::sqrt(rho * local / dt_);  // rho sqrt(nu dt)/dt
    sums[0] += layer * layer * area.squaredNorm() * (w[b] - guess_[b]).squaredNorm();
    sums[1] += load.squaredNorm();
    sums[2] += load.dot(area);
    sums[3] += area.squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const auto share = [&](double load) { return load > 0 ? std::sqrt(sums[0] / load) : 0; };
  return {share(sums[3] > 0 ? sums[1] - sums[2] * sums[2] / sums[3] : 0), share(sums[1])};
}

/// Rejects velocities of a failing structure that no fluid can follow. Motion by less than the adjacent
/// cell's height per step is accepted even in a fluid at rest, and so are bodies with prescribed motion.
template <int D>
void Fluid<D>::check_wall_velocity() const {
  double worst = 0;
  Index where = -1;
  for (const std::string& name : boundary_.interface_patches()) {
    const mesh::Patch& patch = *mesh_.find_patch(name);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Index b = f - mesh_.n_interior;
      const double square = last_w_[b].squaredNorm();
      const double height = 2 * step_.to().area[f].norm() / step_.to().conductance[f];
      if (square <= worst || std::sqrt(square) * dt_ <= height) continue;
      worst = std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
      where = b;
    }
  }
  const double limit = level().largest_speed > 0 ? most_times_faster * level().largest_speed : most_speed;
  if (!parallel::any(mesh_.comm, !(std::sqrt(worst) <= limit))) return;
  struct {
    double value;
    int rank;
  } first{worst, parallel::comm_rank(mesh_.comm)};
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh_.comm);
  Vec3 place = where < 0 ? Vec3(Vec3::Zero()) : level().placement->boundary_centre[where];
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, first.rank, mesh_.comm);
  throw SolveFailure(
      "The velocity of the interface {} at t = {:.6g} s near ({:.6g}, {:.6g}, {:.6g}) m: the structure or "
      "the coupling diverges.",
      std::isfinite(first.value) ? fmt::format("is {:.3g} m/s", std::sqrt(first.value)) : "is not finite",
      time_ + dt_, place.x(), place.y(), place.z());
}

/// Turn of all walls at the end of the sub-step; that of interface and body faces as far as it is known.
template <int D>
Vectors<D> Fluid<D>::wall_turn(double time) const {
  Vectors<D> turn = given_turn_;
  turn.resize(accepted_.w.size(), Vec<D>::Zero());
  const std::vector<Vec3>& points = step_.points().empty() ? points_at_rest() : step_.points();
  boundary_.add_turn(mesh_, points, time, turn);
  return turn;
}

/// Gives a state the turn of its next level. `turn`: that of the last one on exit.
template <int D>
void Fluid<D>::set_turn_of(State<D>& state, Vectors<D>& turn) const {
  if (parameters_.viscosity_law) state.turn_old = state.turn;
  state.turn.swap(turn);
}

/// Mean of the start and the end of the step.
template <int D>
void Fluid<D>::add_turning() {
  if (!boundary_.walls_turn()) return;
  turn_ = wall_turn(time_ + dt_);
  for (std::size_t b = 0; b < turn_.size(); ++b) {
    Vec<D> mean = 0.5 * turn_[b];
    if (!accepted_.turn.empty()) mean += 0.5 * accepted_.turn[b];
    viscous_force_[b] += turning_force<D>(properties().mu, mean);
  }
}

template <int D>
std::shared_ptr<const PressureLevel<D>> Fluid<D>::pressure() const {
  const auto& latest = accepted_.pressure[0];
  if (!latest || !step_.scene().potential(latest->time)) return latest;
  auto whole = std::make_shared<PressureLevel<D>>(*latest);
  step_.scene().add_potential(*accepted_.placement, properties().rho, *whole);
  return whole;
}

template class Fluid<2>;
template class Fluid<3>;

}  // namespace couplet::fluid
