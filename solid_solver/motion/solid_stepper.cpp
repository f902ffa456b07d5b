// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/motion/solid_stepper.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/equilibrium/load_path.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"
#include "solid_solver/thesis/updated_lagrangian.hpp"

namespace couplet::solid {

SolidStepper::SolidStepper(SolidBody& body)
    : body_(body),
      mesh_(body.mesh()),
      geometry_(body.geometry()),
      parameters_(body.parameters()),
      elastic_(body.elastic()),
      kernel_(body.kernel()),
      ledger_(body) {
  apply_stiffness();
  start_from_rest();
  body_.place_expansion(0);
  if (body.load_path()) body.set_load_factor(0);
  if (body.is_dynamic()) announce_time_scheme();
}

void SolidStepper::announce_time_scheme() const {
  const time::TimeSchemeParameters scheme = scheme_of(parameters_);
  const bool by_auto = parameters_.time_scheme.type == time::TimeScheme::automatic;
  log::info("Time scheme: {}{}{}", time::name(scheme.type),
            !by_auto                                             ? ""
            : scheme.type == time::TimeScheme::generalised_alpha ? " (auto: another program loads the body)"
                                                                 : " (auto)",
            scheme.type == time::TimeScheme::generalised_alpha
                ? fmt::format(", which damps the highest modes by {:.3g} % per step",
                              100 * (1 - scheme.spectral_radius))
            : parameters_.energy_momentum ? ", energy and momenta conserved"
                                          : "");
}

void SolidStepper::start_from_rest() {
  const int dim = mesh_.dim;
  state_.cell_u.assign(std::size_t(mesh_.cells.n_local()) * dim, 0);
  state_.cell_v = state_.cell_u;
  state_.face_u.assign(std::size_t(mesh_.boundary.n_local()) * dim, 0);
  state_.face_v = state_.offset = state_.offset_rate = state_.face_u;
  state_.known.assign(body_.prescribed().size() * dim, 0);
  state_.known_rate = state_.known;
  last_.unknowns.assign(elastic_.n_unknowns(), 0);
  if (body_.is_dynamic() && time::uses_acceleration(scheme_of(parameters_).type))
    state_.cell_a = state_.cell_u;
  const time::TimeScheme scheme = scheme_of(parameters_).type;
  const bool is_after_the_middle =
      scheme == time::TimeScheme::generalised_alpha || scheme == time::TimeScheme::three_point;
  if (body_.is_dynamic() && is_after_the_middle && !body_.boundaries().interface_patches().empty())
    state_.interface.assign(std::size_t(mesh_.boundary.n_owned()) * dim, 0);
  if (body_.is_dynamic() && time::uses_old_level(scheme_of(parameters_).type))
    state_.cell_u_old = state_.cell_v_old = state_.cell_u;
  if (body_.has_mass() && !state_.cell_a.empty()) state_.face_a = state_.face_u;
  if (body_.has_mass() && !state_.cell_u_old.empty()) state_.face_u_old = state_.face_v_old = state_.face_u;
  if (body_.wants_acceleration()) {
    state_.acceleration = state_.mean_acceleration = state_.cell_u;
    state_.face_acceleration = state_.face_u;
  }
  if (!parameters_.initial_velocity.empty()) {
    const auto velocity = fv::make_expressions(parameters_.initial_velocity, dim, "initial-velocity");
    const std::span<const Vec3> faces(geometry_.face_centre.data() + mesh_.n_interior,
                                      mesh_.boundary.n_local());
    for (int c = 0; c < dim; ++c) {
      velocity[c].evaluate(geometry_.cell_centre, 0, state_.cell_v, dim, c);
      velocity[c].evaluate(faces, 0, state_.face_v, dim, c);
    }
  }
  if (!body_.rigid().empty()) {
    std::vector<double> velocity = body_.unknowns_of(state_.cell_v, state_.face_v);
    body_.rigid().project(velocity);
    const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
    const auto& open = elastic_.unknown_faces();
    for (std::size_t i = 0; i < open.size(); ++i)
      std::copy_n(&velocity[n_cells + i * dim], dim,
                  &state_.face_v[std::size_t(open[i] - mesh_.n_interior) * dim]);
    mesh_.boundary.update_ghosts(state_.face_v, dim);
  }
  state_.energies.kinetic = state_.energies.initial_kinetic = ledger_.kinetic(state_);
  trial_ = state_;
}

// Discards all data made for the old constants.
void SolidStepper::apply_stiffness() {
  if (!body_.apply_stiffness()) return;
  systems_.clear();
  body_.thermal()->stiffness_changed();
}

void SolidStepper::begin_step(const coupling::Step& step, bool has_loads) {
  step_ = step;
  effort_ = {};
  if (!(step.dt > 0)) throw Error("The solid received a step of {} s; it must be above 0.", step.dt);
  if (has_loads) prepare_loads();
  if (body_.prescribed().is_zero()) return;
  const double end = step.time + step.dt;
  body_.prescribed().evaluate(end, trial_.known);
  body_.prescribed().check(end, trial_.known);
  if (body_.is_dynamic()) {
    body_.prescribed().evaluate_rate(end, step.dt, trial_.known_rate);
  } else {
    for (std::size_t i = 0; i < trial_.known.size(); ++i)
      trial_.known_rate[i] = (trial_.known[i] - state_.known[i]) / step.dt;
  }
}

void SolidStepper::prepare_loads() {
  const std::vector<time::Stage> stages = stages_of(step_.dt);
  stages_.resize(stages.size());
  if (body_.load_path()) body_.set_load_factor(1);
  if (body_.thermal()) body_.thermal()->begin_step(step_);
  apply_stiffness();
  for (std::size_t i = 0; i < stages.size(); ++i) {
    stages_[i].stage = stages[i];
    prepare_stage(stages_[i]);
  }
}

void SolidStepper::solve(std::vector<double> interface_load) {
  last_.interface = std::move(interface_load);
  try {
    for (std::size_t i = 0; i < stages_.size(); ++i) solve_stage(stages_[i], i == 0);
  } catch (const SolveFailure& failure) {
    if (!body_.is_dynamic() && step_.scheme == coupling::Scheme::standalone && !body_.large_strain())
      throw SchemeFailure("The static step failed, and a shorter step would solve the same equations: {}",
                          failure.what());
    throw;
  }
  trial_.time = step_.time + step_.dt;
  trial_.dt = step_.dt;
  trial_.steps = state_.steps + 1;
  if (!state_.cell_u_old.empty()) {
    trial_.cell_u_old = state_.cell_u;
    trial_.cell_v_old = state_.cell_v;
    if (body_.has_mass()) trial_.face_u_old = state_.face_u, trial_.face_v_old = state_.face_v;
  }
  if (!state_.interface.empty() && !last_.interface.empty()) trial_.interface = last_.interface;
  if (!trial_.acceleration.empty()) finish_acceleration();
  elastic_.impose_known(trial_.known, trial_.face_u);
  elastic_.impose_known(trial_.known_rate, trial_.face_v);
  update_trial_ghosts();
  if (UpdatedLagrangian* updated = body_.updated_lagrangian())
    updated->end_step(body_.unknowns_of(trial_.cell_u, trial_.face_u), trial_.known);
  if (parameters_.step_control) judge_step();
}

void SolidStepper::update_trial_ghosts() {
  mesh_.cells.update_ghosts(trial_.cell_u, mesh_.dim);
  mesh_.cells.update_ghosts(trial_.cell_v, mesh_.dim);
  mesh_.boundary.update_ghosts(trial_.face_u, mesh_.dim);
  mesh_.boundary.update_ghosts(trial_.face_v, mesh_.dim);
  elastic_.join_twins(trial_.face_u);
  elastic_.join_twins(trial_.face_v);
}

void SolidStepper::accept_step() {
  if (body_.thermal()) body_.thermal()->accept_step();
  for (const StageWork& work : stages_)
    if (linalg::ResidualProjection* projection = work.system->projection()) projection->accept();
  if (UpdatedLagrangian* updated = body_.updated_lagrangian()) updated->accept();
  if (LoadPath* path = body_.load_path())
    path->accept(trial_.time, body_.lowest_stiffness(last_.unknowns, trial_.known));
  std::swap(state_, trial_);
  body_.place_expansion(state_.time);
}

void SolidStepper::release_solver() {
  // A dynamic run may be continued, with the same first guesses.
  if (step_.is_last && !body_.is_dynamic() && !systems_.empty()) {
    systems_.clear();
    malloc_trim(0);  // a third of all that plate B of 294 912 cells held: in holes otherwise
  }
}

// Local error of a step, and the resulting step size.

namespace {

// Safety factor of the tolerance for the next step, so that few steps are rejected.
constexpr double safety = 0.85;

// Share of the tolerance per step, because errors add up until damping and dissipation reduce them.
constexpr double share_of_a_step = 0.1;

}  // namespace

// Error of a step: constant dt^3 d3u/dt3 (Euler: constant dt^2 d2u/dt2) with d3u/dt3 from the mean
// accelerations of the last two steps. A coupled step is not rejected here, because its iterates precede
// convergence of the load.
void SolidStepper::judge_step() {
  const time::LocalError local = time::local_error(scheme_of(parameters_));
  const double dt = step_.dt, apart = 0.5 * (dt + state_.dt);
  double error = 0, volume = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double v = geometry_.volume[c];
    for (int a = 0; a < mesh_.dim; ++a) {
      const std::size_t i = std::size_t(c) * mesh_.dim + a;
      const double derivative = local.order == 1
                                    ? trial_.mean_acceleration[i]
                                    : (trial_.mean_acceleration[i] - state_.mean_acceleration[i]) / apart;
      error += v * derivative * derivative;
    }
    volume += v;
  }
  volume = parallel::sum(mesh_.comm, volume);
  trial_.error =
      local.constant * std::pow(dt, local.order + 1) * std::sqrt(parallel::sum(mesh_.comm, error) / volume);
  if (step_.scheme != coupling::Scheme::standalone) return;
  const double tolerance = share_of_a_step * parameters_.step_control->tolerance;
  if (trial_.error > tolerance)
    throw SolveFailure("The estimated step error, {:.2g} m, exceeds a tenth of the tolerance, {:g} m.",
                       trial_.error, tolerance);
}

double SolidStepper::suggest_dt() const {
  if (!(state_.error > 0)) return std::numeric_limits<double>::infinity();
  const double room = share_of_a_step * parameters_.step_control->tolerance / state_.error;
  return safety * state_.dt * std::pow(room, 1. / (time::local_error(scheme_of(parameters_)).order + 1));
}

}  // namespace couplet::solid
