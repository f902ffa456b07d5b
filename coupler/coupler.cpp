// SPDX-License-Identifier: Apache-2.0
#include "coupler/coupler.hpp"

#include <algorithm>
#include <limits>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"

namespace couplet {

Coupler::Coupler(const CouplingParameters& parameters, const SimulationParameters& simulation,
                 CouplerChannels channels, CouplerFolders folders)
    : parameters_(parameters),
      simulation_(simulation),
      folders_(std::move(folders)),
      loop_(MPI_COMM_SELF, simulation, parameters.scheme, folders_.checkpoints),
      acceleration_(parameters.acceleration) {
  fluid_.channel = std::move(channels.fluid);
  structure_.channel = std::move(channels.structure);
  mesh_.channel = std::move(channels.mesh);
}

std::vector<Partner*> Coupler::everyone() {
  // The mesh mover first: the fluid waits for its motion.
  if (mesh_.channel) return {&mesh_, &fluid_, &structure_};
  return {&fluid_, &structure_};
}

void Coupler::initialise() {
  enter_(Phase::initialise, {});
  const std::vector<Partner*> partners = everyone();
  std::vector<Interface> interfaces = initialise_all(partners);
  std::vector<Side> sides;
  for (std::size_t i = 0; i < partners.size(); ++i)
    sides.push_back({partners[i]->name(), std::move(interfaces[i])});
  std::optional<Side> mesh;
  if (mesh_.channel) mesh = sides.front();
  wiring_.emplace(sides[sides.size() - 2], sides.back(), mesh, parameters_.mapping);
  for (const std::string& note : wiring_->notes()) log::info("{}", note);
  history_.now.displacement.assign(wiring_->n_unknowns(), 0.);
  history_.now.velocity.assign(wiring_->n_unknowns(), 0.);
}

InterfaceState Coupler::pass(const InterfaceState& x, bool move_mesh) {
  // The fluid blocks until the mesh has been moved: its command goes out before any reply is awaited.
  if (move_mesh) mesh_.send({Op::solve, {}, wiring_->to_mesh(x), 0, -1, ""});
  fluid_.send({Op::solve, {}, wiring_->to_fluid(x), 0, -1, ""});
  // A failed motion makes the fluid fail too; the mover knows the reason. Both replies are always taken.
  std::optional<SolveFailure> mover_failed;
  if (move_mesh) {
    try {
      mesh_.receive();
    } catch (const SolveFailure& failure) {
      mover_failed = failure;
    }
  }
  try {
    last_given_ = fluid_.receive().data;
  } catch (const SolveFailure&) {
    if (!mover_failed) throw;
  }
  if (mover_failed) throw SolveFailure(*mover_failed);
  last_load_ = wiring_->to_structure(last_given_);
  structure_.send({Op::solve, {}, last_load_, 0, -1, ""});
  return wiring_->from_structure(structure_.receive().data);
}

std::optional<std::string> Coupler::attempt(const Step& step) {
  enter_(Phase::begin_step, step.time);
  for (Partner* p : everyone()) p->seconds = 0;
  try {
    ask_all(everyone(), {Op::begin_step, step, {}, 0, -1, ""});
    enter_(Phase::solve, step.time);
    InterfaceState guess = predict(history_, step.dt, parameters_.predictor_order);
    const bool move_always = parameters_.scheme != Scheme::semi_implicit;
    bool first = true;
    const FixedPointMap map = [&](const InterfaceState& x) {
      ++iterations_;
      const bool move_mesh = mesh_.channel && (first || move_always);
      first = false;
      return pass(x, move_mesh);
    };
    const IterationObserver observer = [&](int k, const Residual& residual, double omega) {
      monitor_->iteration(step, k, residual, omega);
    };
    ConvergenceParameters convergence = parameters_.convergence;
    if (parameters_.scheme == Scheme::explicit_) {
      // One pass, whatever its residual.
      convergence.max_iterations = 1;
      convergence.relative = std::numeric_limits<double>::infinity();
    }
    last_ = solve_fixed_point(std::move(guess), wiring_->dim(), map, convergence, acceleration_, observer);
    last_dt_ = step.dt;
  } catch (const SolveFailure& failure) {
    return failure.what();
  }
  return {};
}

void Coupler::accept(double time, int output) {
  enter_(Phase::accept, {});
  const std::vector<double> before = history_.now.displacement;
  ask_all(everyone(), {Op::accept_step, {}, {}, time, output, ""});
  enter_(Phase::accept, time);
  const auto increment = [&](const std::vector<double>& displacement) {
    std::vector<double> result(displacement.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = displacement[i] - before[i];
    return result;
  };
  monitor_->balance(time,
                    wiring_->fluid_balance(last_given_, wiring_->at_fluid(increment(last_.x.displacement))),
                    wiring_->structure_balance(last_load_, increment(last_.image.displacement)));
  history_.old_velocity = std::move(history_.now.velocity);
  history_.now = last_.image;
  history_.old_dt = last_dt_;
}

void Coupler::save(const std::filesystem::path& folder) {
  enter_(Phase::save, {});
  ask_all(everyone(), {Op::save, {}, {}, 0, -1, folder.string()});
  CheckpointWriter file(MPI_COMM_SELF, folder / "coupler.h5");
  file.write("displacement", history_.now.displacement);
  file.write("velocity", history_.now.velocity);
  file.write("old-velocity", history_.old_velocity);
  file.write_scalar("old-dt", history_.old_dt);
  file.write_scalar("omega", acceleration_.omega());
  file.close();
}

void Coupler::load() {
  enter_(Phase::load, {});
  CheckpointReader file(MPI_COMM_SELF, folders_.restart / "coupler.h5");
  file.read("displacement", history_.now.displacement);
  file.read("velocity", history_.now.velocity);
  history_.old_velocity = file.read("old-velocity");
  history_.old_dt = file.read_scalar("old-dt");
  acceleration_.restore(file.read_scalar("omega"));
  const RunState state = read_run_state(folders_.restart);
  loop_.restart(state);
  ask_all(everyone(), {Op::load, {}, {}, state.time, -1, folders_.restart.string()});
  log::info("continues from {} at t = {:g} s", folders_.restart.string(), state.time);
}

void Coupler::finalise() {
  enter_(Phase::finalise, {});
  log::info("{}", monitor_->summary(loop_.halvings()));
  finalise_all(everyone());
}

std::string Coupler::run() {
  initialise();
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  if (!folders_.restart.empty()) {
    load();
    restart_time = read_run_state(folders_.restart).time;
  }
  monitor_.emplace(folders_.output, wiring_->dim(), simulation_.end_time, restart_time);
  StepActions actions;
  actions.attempt = [&](const Step& step) { return attempt(step); };
  actions.accept = [&](double time, int output) { accept(time, output); };
  actions.write_start = [&](int output) { ask_all(everyone(), {Op::write_output, {}, {}, 0, output, ""}); };
  actions.save = [&](const std::filesystem::path& folder) { save(folder); };
  actions.report = [&](const Step& step, double time) {
    std::vector<Partner*> partners{&fluid_, &structure_};
    if (mesh_.channel) partners.push_back(&mesh_);
    monitor_->step(step, time, last_, seconds_of(partners));
  };
  actions.advised_dt = [&] { return advised_dt(everyone()); };
  std::string problem = loop_.run(actions);
  finalise();
  return problem;
}

}  // namespace couplet
