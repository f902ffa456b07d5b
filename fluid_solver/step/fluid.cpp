// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/fluid.hpp"

#include <algorithm>

#include "fluid_solver/step/fluid_checks.hpp"

namespace couplet::fluid {

template <int D>
Fluid<D>::Fluid(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters,
                bool moving_mesh, double start_time)
    : mesh_(mesh),
      parameters_(with_surfaces(parameters, moving_mesh)),
      path_(mesh, geometry, parameters_, moving_mesh),
      boundary_(mesh, geometry, parameters_),
      step_(mesh, path_.points_at_rest(), boundary_, parameters_, moving_mesh && !path_.translates()),
      sizes_(mesh, boundary_, parameters_) {
  check_together(mesh_, boundary_, parameters_, moving_mesh);
  start(geometry, start_time);
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
void Fluid<D>::restore(State<D> state) {
  accepted_ = std::move(state);
  accepted_.number = 0;
  if (path_.translates()) accepted_.placement = path_.at(accepted_.points);
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
  sizes_.begin_step(accepted_, time, dt, step_.frame() ? step_.frame()->rate(time, dt) : 0, begin_);
  statistics_.sub_steps = 0;
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
  path_.refuse_torn(points, time_ + dt_);
  pressure_done_.assign(accepted_.w.size(), Vec<D>::Zero());
  viscous_done_ = pressure_done_;
  double done = 0;
  for (bool last = false; !last;) {
    const double dt = sizes_.next(level(), history_.implicit, statistics_.sub_steps, dt_ - done, last);
    const double end = last ? dt_ : done + dt;
    SubStep<D> sub_step = path_.sub_step(level(), dt, end / dt_, accepted_.points, points, time_);
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
