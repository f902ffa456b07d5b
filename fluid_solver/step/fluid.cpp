// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/fluid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/log/timer.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/motion/body_start.hpp"
#include "fluid_solver/step/fluid_checks.hpp"

namespace couplet::fluid {
namespace {

constexpr int most_sub_steps = 100000;
// The implicit viscous term costs about this much more a sub-step.
constexpr double implicit_cost = 1.5;

double parts(double dt, double limit) {
  return std::isfinite(limit) ? std::max(1.0, std::ceil(dt / limit - 1e-9)) : 1.0;
}

/// A frame that is only translated keeps its shape, and with it the pressure equation and its factors. Null: none.
template <int D>
std::shared_ptr<const Placement<D>> placed(const Mesh& mesh, const Placement<D>* frame,
                                           std::span<const Vec3> points) {
  if (!frame) return make_placement<D>(mesh, points);
  return translated(*frame, points.empty() ? Vec3(Vec3::Zero()) : Vec3(points[0] - mesh.reference_points[0]));
}

}  // namespace

template <int D>
Fluid<D>::Fluid(const Mesh& mesh, const FluidParameters& parameters, bool moving_mesh, double start_time)
    : mesh_(mesh),
      parameters_(parameters),
      moving_(moving_mesh),
      translates_(parameters.motion && parameters.motion->translates()),
      boundary_(mesh, parameters_),
      step_(mesh, boundary_, parameters_, moving_mesh && !translates_),
      step_size_(mesh, boundary_, parameters.viscosity / parameters.density, parameters.scheme) {
  check_together(mesh_, boundary_, parameters_, moving_);
  if (moving_ && !translates_ &&
      any(mesh.comm, !mesh.neighbour_shift.empty()))  // a rank without cells has none
    periodic_.emplace(mesh);
  start(start_time);
}

/// The first two stages of Heun's scheme, each a step from level n with its own pressure,
///   u' = P(u^n + dt/3 R(u^n)),  u'' = P(u^n + 2/3 dt R(u')),  u^{n+1} = P(u^n + dt [R(u^n) + 3 R(u'')]/4),
/// and what the last one needs. `done`: time into the coupling step at the begin of the sub-step.
template <int D>
void Fluid<D>::run_stages(SubStep<D>& step, double done, const Vectors<D>& wall_velocity) {
  Vectors<D> rate, shear;
  step_.rates(level(), rate, shear);
  step.rate = rate;
  step.shear = shear;
  for (const double share : {1.0 / 3, 2.0 / 3}) {
    SubStep<D> part;
    part.dt = share * step.dt;
    part.to = step.to;
    part.rate = rate;
    part.shear = shear;
    State<D> stage = level();
    const Vectors<D> w = wall_velocity_at(done + part.dt, wall_velocity, part);
    step_.predict(stage, history_, std::move(part), w);
    step_.project(stage, w);
    step_.commit(stage);
    step_.rates(stage, rate, shear);
  }
  for (std::size_t c = 0; c < rate.size(); ++c) step.rate[c] = 0.25 * step.rate[c] + 0.75 * rate[c];
  for (std::size_t b = 0; b < shear.size(); ++b) step.shear[b] = 0.25 * step.shear[b] + 0.75 * shear[b];
}

template <int D>
void Fluid<D>::start(double time) {
  State<D>& s = accepted_;
  s.time = time;
  if (moving_) s.points = mesh_.reference_points;
  s.placement = moving_ ? make_placement<D>(mesh_, s.points) : make_placement<D>(mesh_, mesh_.reference);
  if (translates_) {
    auto frame = std::make_shared<Placement<D>>(*s.placement);
    frame->shape = std::make_shared<const char>();
    s.placement = frame_ = std::move(frame);
  }
  const Placement<D>& at = *s.placement;
  s.u.assign(mesh_.cells.n_local(), Vec<D>::Zero());
  s.w.assign(mesh_.boundary.n_owned(), Vec<D>::Zero());
  s.u_boundary = s.w;
  if (!parameters_.initial_velocity.empty()) {
    const auto expressions = make_expressions(parameters_.initial_velocity, D, "initial-velocity");
    for (int c = 0; c < D; ++c) {
      expressions[c].evaluate(mesh_.reference.cell_centre, time, flat<D>(s.u), D, c);
      expressions[c].evaluate(at.boundary_centre, time, flat<D>(s.u_boundary), D, c);
    }
  }
  // Without an initial velocity the fluid is at rest, its boundaries too: what they do from then on is an
  // impulse in the first step, which an elastic wall must feel. A given field is made to fit its boundaries
  // instead.
  s.start = parameters_.initial_velocity.empty() ? Start::at_rest : Start::flowing;
  if (s.start == Start::flowing) {
    boundary_.velocity_at(time, at.boundary_centre, s.w);
    if (boundary_.walls_turn()) {
      s.turn.assign(s.w.size(), Vec<D>::Zero());
      boundary_.add_turn(mesh_, mesh_.reference_points, time, s.turn);
      s.turns = true;
    }
    if (parameters_.motion) set_body_start(mesh_, boundary_, *parameters_.motion, time, s.w, s.turn);
  }
  for (std::size_t b = 0; b < s.w.size(); ++b)
    if (boundary_.is_convective(b)) s.w[b] = s.u_boundary[b];
  for (const Index b : boundary_.rows().of_pressure) s.u_boundary[b] = s.u[mesh_.owner[mesh_.n_interior + b]];
  step_.project_initial(s);
  const Expression initial_pressure(parameters_.initial_pressure.value_or(config::ExpressionText{}),
                                    "initial-pressure");
  const bool is_state =
      parameters_.is_compressible() && (parameters_.initial_pressure || s.start == Start::at_rest);
  if (is_state || !initial_pressure.is_zero()) {
    auto level = std::make_shared<PressureLevel<D>>();
    level->time = time;
    level->p.resize(mesh_.cells.n_local());
    level->boundary.resize(s.w.size());
    initial_pressure.evaluate(mesh_.reference.cell_centre, time, level->p);
    initial_pressure.evaluate(at.boundary_centre, time, level->boundary);
    if (step_.frame()) add_centrifugal(*step_.frame(), at, -parameters_.density, *level);
    step_.start_level(at, *level);
    s.pressure[0] = level;
  }
  step_.start_waves(s);
  s.implicit = parameters_.viscous == ViscousTreatment::implicit;
  step_.set_eddy_viscosity(s);
  step_.keep();
}

template <int D>
void Fluid<D>::restore(State<D> state) {
  accepted_ = std::move(state);
  accepted_.number = 0;
  if (translates_) accepted_.placement = placed(mesh_, frame_.get(), accepted_.points);
  split_ = false;
  step_.mark_level(accepted_);
  step_.set_eddy_viscosity(accepted_);
}

template <int D>
void Fluid<D>::begin_step(double time, double dt) {
  time_ = time;
  dt_ = dt;
  split_ = false;
  begin_ = accepted_;
  begin_.time = time;
  if (step_.frame()) step_size_.set_frame_rate(step_.frame()->rate(time, dt));
  if (!parameters_.time_step) statistics_.limits = step_size_.limits(accepted_);
  if (parameters_.viscous == ViscousTreatment::automatic) choose_viscous_treatment();
  statistics_.sub_steps = 0;
}

// With a step of its own the fluid keeps it whatever the treatment: implicit if the explicit one would not be
// stable. Else the cheaper one; a change starts the multi-step schemes anew, so it needs a clear gain.
template <int D>
void Fluid<D>::choose_viscous_treatment() {
  const StepLimits& limits = statistics_.limits;
  bool implicit = begin_.implicit;
  if (parameters_.time_step) {
    const double own = dt_ / parts(dt_, *parameters_.time_step);
    implicit = step_size_.explicit_viscous_limit_is_below(
        own * (implicit ? 1.3 : 1.0) / parameters_.safety_factor, accepted_);
  } else {
    const double with_explicit = parts(dt_, parameters_.safety_factor * limits.explicit_viscous);
    const double with_implicit =
        implicit_cost * parts(dt_, parameters_.safety_factor * implicit_limit(limits));
    if (implicit && with_explicit < 0.7 * with_implicit) implicit = false;
    if (!implicit && with_implicit < 0.9 * with_explicit) implicit = true;
  }
  if (implicit == begin_.implicit) return;
  begin_.implicit = implicit;
  begin_.dt_old = 0;
}

/// By stability, and by accuracy where that is asked for.
template <int D>
double Fluid<D>::implicit_limit(const StepLimits& limits) const {
  if (!parameters_.implicit_stretch) return limits.implicit_viscous;
  return std::min(limits.implicit_viscous, *parameters_.implicit_stretch * limits.explicit_viscous);
}

/// Equal parts of what remains, each within the limit of the present flow.
template <int D>
double Fluid<D>::next_size(double remaining, bool& last) {
  double limit = 0;
  if (parameters_.time_step) {
    limit = *parameters_.time_step;
  } else {
    const StepLimits limits = statistics_.sub_steps == 0 ? statistics_.limits : step_size_.limits(level());
    limit =
        parameters_.safety_factor * (history_.implicit ? implicit_limit(limits) : limits.explicit_viscous);
  }
  const double n = parts(remaining, limit);
  if (!(n + statistics_.sub_steps <= most_sub_steps))
    throw SolveFailure(
        "The fluid would need more than {} sub-steps of {:.3g} s for the step of {:.3g} s at t = {:.6g} s. {}",
        most_sub_steps, limit, dt_, time_,
        parameters_.time_step ? " It follows from 'time-step'."
                              : in_words(step_size_.limiter(level(), history_.implicit)));
  last = n == 1;
  return remaining / n;
}

template <int D>
SubStep<D> Fluid<D>::make_sub_step(double dt, double done, std::span<const Vec3> points) const {
  SubStep<D> step;
  step.dt = dt;
  step.to = level().placement;
  if (!moving_) return step;
  const double s = done / dt_;
  if (s == 1 || points.empty()) {
    step.points = points.empty() ? accepted_.points : std::vector<Vec3>(points.begin(), points.end());
  } else {
    step.points.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      step.points[i] = accepted_.points[i] + s * (points[i] - accepted_.points[i]);
  }
  step.to = placed(mesh_, frame_.get(), step.points);
  if (!translates_) refuse_inverted(*step.to);
  step.swept = swept_volumes(mesh_, level().points, step.points);
  step.swept.resize(mesh_.n_flux_faces());
  return step;
}

template <int D>
Vectors<D> Fluid<D>::wall_velocity_at(double done, const Vectors<D>& interface_velocity,
                                      const SubStep<D>& step) const {
  const double s = done / dt_;
  Vectors<D> w(accepted_.w.size(), Vec<D>::Zero());
  if (!interface_velocity.empty())
    for (std::size_t b = 0; b < w.size(); ++b)
      if (boundary_.is_interface(b)) w[b] = accepted_.w[b] + s * (interface_velocity[b] - accepted_.w[b]);
  boundary_.velocity_at(time_ + done, step.to->boundary_centre, w);
  boundary_.convect(mesh_, *level().placement, level().u, level().w, step.dt, w);
  return w;
}

// The implicit predictor and the non-orthogonal part need the pressure of the step before: at the very first
// step it comes from a trial of the step.
template <int D>
void Fluid<D>::start_pressure(const SubStep<D>& step, const Vectors<D>& w) {
  History<D> probe = history_;
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
  statistics_.sub_steps = 0;
  if (periodic_ && !points.empty()) refuse_torn(mesh_, *periodic_, points, time_ + dt_);
  pressure_done_.assign(accepted_.w.size(), Vec<D>::Zero());
  viscous_done_ = pressure_done_;
  double done = 0;
  for (bool last = false; !last;) {
    const double dt = next_size(dt_ - done, last);
    const double end = last ? dt_ : done + dt;
    SubStep<D> sub_step = make_sub_step(dt, end, points);
    last_w_ = wall_velocity_at(end, wall_velocity, sub_step);
    if (history_.start == Start::after_impulse) {
      // The pressure of a compressible fluid is no impulse, but its state.
      if (!parameters_.is_compressible()) history_.pressure = {};
      history_.start = Start::flowing;
    }
    const bool needs_pressure =
        history_.implicit || step_.oblique() || parameters_.projection == Projection::incremental;
    if (needs_pressure && !history_.pressure[0]) start_pressure(sub_step, last_w_);
    if (parameters_.scheme == ExplicitScheme::runge_kutta) run_stages(sub_step, end - dt, wall_velocity);
    sub_step.yields = last && yields_;
    step_.predict(level(), history_, std::move(sub_step), last_w_);
    ++statistics_.sub_steps;
    ++statistics_.all_sub_steps;
    if (last) break;
    step_.project(level(), last_w_);
    add_forces(dt / dt_);
    pressure_done_.swap(pressure_force_);
    viscous_done_.swap(viscous_force_);
    step_.complete(level());
    if (!split_) trial_ = accepted_;
    split_ = true;
    step_.commit(trial_);
    history_ = trial_;
    done = end;
  }
  if (!boundary_.interface_patches().empty()) guess_ = last_w_;
}

template <int D>
void Fluid<D>::solve_pressure(const Vectors<D>& wall_velocity, double answer) {
  if (!wall_velocity.empty())
    for (std::size_t b = 0; b < last_w_.size(); ++b)
      if (boundary_.is_interface(b)) last_w_[b] = wall_velocity[b];
  check_wall_velocity();
  step_.project(level(), last_w_, answer);
  // Once a prediction: what a repetition changes is the potential flow of a bounded wall velocity.
  if (!judged_) step_.complete(level());
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
  if (split_) std::swap(accepted_, trial_);
  split_ = false;
  step_.commit(accepted_);
  step_.keep();
  accepted_.time = time_ + dt_;
  accepted_.turn.swap(turn_);
  accepted_.turns = boundary_.walls_turn();
  statistics_.pressure_iterations = step_.statistics().pressure_iterations;
  statistics_.viscous_iterations = step_.statistics().viscous_iterations;
}

template class Fluid<2>;
template class Fluid<3>;

}  // namespace couplet::fluid
