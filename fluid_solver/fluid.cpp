// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/fluid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/log/timer.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

constexpr int most_sub_steps = 100000;
// An interface faster than so many times all that moved so far (at the very start: than this [m/s]) diverges.
constexpr double most_times_faster = 1e4, most_speed = 1e8;
// The implicit viscous term costs about this much more a sub-step.
constexpr double implicit_cost = 1.5;

double parts(double dt, double limit) {
  return std::isfinite(limit) ? std::max(1.0, std::ceil(dt / limit - 1e-9)) : 1.0;
}

}  // namespace

template <int D>
Fluid<D>::Fluid(const Mesh& mesh, const FluidParameters& parameters, bool moving_mesh, double start_time)
    : mesh_(mesh),
      parameters_(parameters),
      moving_(moving_mesh),
      boundary_(mesh, parameters_),
      step_(mesh, boundary_, parameters_, moving_mesh),
      step_size_(mesh, boundary_, parameters.viscosity / parameters.density, parameters.scheme) {
  if (!parameters.bodies.empty()) check_bodies();
  if (!parameters.gaps.empty() && boundary_.closed())
    throw Error("gaps: a fluid with gaps that close needs an outlet: its blocked cells keep what they hold.");
  if (parameters.scheme == ExplicitScheme::runge_kutta) check_scheme();
  start(start_time);
}

template <int D>
void Fluid<D>::check_bodies() {
  if (!parameters_.gaps.empty())
    throw Error("gaps: a fluid with immersed bodies has none; leave 'gaps' or 'bodies' out.");
  if (moving_)
    throw Error("bodies: the mesh of a fluid with immersed bodies must rest; remove its mesh mover.");
  if (boundary_.closed())
    throw Error("bodies: a fluid with immersed bodies needs an outlet, since they may displace fluid.");
  if (parameters_.viscous == ViscousTreatment::implicit)
    throw Error("viscous: implicit is not possible with immersed bodies, which act on the explicit step.");
  parameters_.viscous = ViscousTreatment::explicit_;
}

template <int D>
void Fluid<D>::check_scheme() {
  if (moving_)
    throw Error("scheme: runge-kutta needs a mesh at rest; use adams-bashforth with a mesh mover.");
  if (parameters_.viscous == ViscousTreatment::implicit)
    throw Error(
        "scheme: runge-kutta takes the viscous term explicitly; use 'viscous: explicit' or adams-bashforth.");
  parameters_.viscous = ViscousTreatment::explicit_;
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
  if (s.start == Start::flowing) boundary_.velocity_at(time, at.boundary_centre, s.w);
  for (std::size_t b = 0; b < s.w.size(); ++b)
    if (boundary_.is_convective(b)) s.w[b] = s.u_boundary[b];
  for (std::size_t b = 0; b < s.w.size(); ++b)
    if (boundary_.kind()[b] == FaceKind::pressure) s.u_boundary[b] = s.u[mesh_.owner[mesh_.n_interior + b]];
  step_.project_initial(s);
  const Expression initial_pressure(parameters_.initial_pressure, "initial-pressure");
  if (!initial_pressure.is_zero()) {
    auto level = std::make_shared<PressureLevel<D>>();
    level->time = time;
    level->p.resize(mesh_.cells.n_local());
    level->boundary.resize(s.w.size());
    initial_pressure.evaluate(mesh_.reference.cell_centre, time, level->p);
    initial_pressure.evaluate(at.boundary_centre, time, level->boundary);
    step_.set_gradient(at, *level);
    s.pressure[0] = level;
  }
  s.implicit = parameters_.viscous == ViscousTreatment::implicit;
  step_.set_eddy_viscosity(s);
}

template <int D>
void Fluid<D>::restore(State<D> state) {
  accepted_ = std::move(state);
  accepted_.number = 0;
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
        "The fluid would need more than {} sub-steps of {:.3g} s for the step of {:.3g} s at t = {:.6g} s.",
        most_sub_steps, limit, dt_, time_);
  last = n == 1;
  return remaining / n;
}

/// Whoever moved the points: a cell turned over has no flow.
template <int D>
void Fluid<D>::refuse_inverted(const Placement<D>& at) const {
  struct {
    double value;
    int rank;
  } least{std::numeric_limits<double>::infinity(), comm_rank(mesh_.comm)};
  Index where = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    if (at.volume[c] >= least.value) continue;
    least.value = at.volume[c];
    where = c;
  }
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE_INT, MPI_MINLOC, mesh_.comm);
  if (least.value > 0) return;
  Vec3 place = Vec3::Zero();
  if (mesh_.cells.n_owned() > 0) place.template head<D>() = at.centre[where];
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, least.rank, mesh_.comm);
  throw SolveFailure(
      "The motion of the mesh from t = {:.6g} s turns a cell over near ({:.6g}, {:.6g}, {:.6g}) m (volume "
      "{:.3e} m^3).",
      time_, place.x(), place.y(), place.z(), least.value);
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
  step.to = make_placement<D>(mesh_, step.points);
  refuse_inverted(*step.to);
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
  pressure_done_.assign(accepted_.w.size(), Vec<D>::Zero());
  viscous_done_ = pressure_done_;
  double done = 0;
  for (bool last = false; !last;) {
    const double dt = next_size(dt_ - done, last);
    const double end = last ? dt_ : done + dt;
    SubStep<D> sub_step = make_sub_step(dt, end, points);
    last_w_ = wall_velocity_at(end, wall_velocity, sub_step);
    if (history_.start == Start::after_impulse) {
      history_.pressure = {};
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

/// The layer that a wall drags along within a step is rho sqrt(nu dt) thick: a mass that acts on w* in the
/// loop, see docs/theory.md.
template <int D>
double Fluid<D>::unseen_share() const {
  const double layer = std::sqrt(parameters_.density * parameters_.viscosity / dt_);  // rho sqrt(nu dt)/dt
  double sums[4] = {};  // unseen^2, load^2, load.S, S^2
  for (std::size_t b = 0; b < guess_.size(); ++b) {
    if (!boundary_.is_interface(static_cast<Index>(b))) continue;
    const Vec<D>& area = level().placement->area[mesh_.n_interior + static_cast<Index>(b)];
    const Vec<D> load = pressure_force_[b] + viscous_force_[b];
    sums[0] += layer * layer * area.squaredNorm() * (last_w_[b] - guess_[b]).squaredNorm();
    sums[1] += load.squaredNorm();
    sums[2] += load.dot(area);
    sums[3] += area.squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double load = sums[3] > 0 ? sums[1] - sums[2] * sums[2] / sums[3] : 0;
  return load > 0 ? std::sqrt(sums[0] / load) : 0;
}

/// A structure that fails gives velocities that no fluid can follow.
template <int D>
void Fluid<D>::check_wall_velocity() const {
  double worst = 0;
  Index where = -1;
  for (std::size_t b = 0; b < last_w_.size(); ++b) {
    const double square = last_w_[b].squaredNorm();
    if (square <= worst || !boundary_.is_interface(static_cast<Index>(b))) continue;
    worst = std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
    where = static_cast<Index>(b);
  }
  const double limit = step_.largest_speed() > 0 ? most_times_faster * step_.largest_speed() : most_speed;
  if (!any(mesh_.comm, !(std::sqrt(worst) <= limit))) return;
  struct {
    double value;
    int rank;
  } first{worst, comm_rank(mesh_.comm)};
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh_.comm);
  Vec3 place = where < 0 ? Vec3(Vec3::Zero()) : level().placement->boundary_centre[where];
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, first.rank, mesh_.comm);
  throw SolveFailure(
      "The velocity of the interface {} at t = {:.6g} s near ({:.6g}, {:.6g}, {:.6g}) m: the structure or "
      "the coupling diverges.",
      std::isfinite(first.value) ? fmt::format("is {:.3g} m/s", std::sqrt(first.value)) : "is not finite",
      time_ + dt_, place.x(), place.y(), place.z());
}

template <int D>
void Fluid<D>::solve_pressure(const Vectors<D>& wall_velocity) {
  if (!wall_velocity.empty())
    for (std::size_t b = 0; b < last_w_.size(); ++b)
      if (boundary_.is_interface(b)) last_w_[b] = wall_velocity[b];
  check_wall_velocity();
  step_.project(level(), last_w_);
  // Once a prediction: what a repetition changes is the potential flow of a bounded wall velocity.
  if (!judged_) step_.complete(level());
  judged_ = true;
  ++statistics_.pressure_solves;
  add_forces(step_.size() / dt_);
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
  accepted_.time = time_ + dt_;
  statistics_.pressure_iterations = step_.statistics().pressure_iterations;
  statistics_.viscous_iterations = step_.statistics().viscous_iterations;
}

template class Fluid<2>;
template class Fluid<3>;

}  // namespace couplet::fluid
