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
      accelerator_(make_accelerator(parameters.acceleration, MPI_COMM_SELF)) {
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
  check_places(sides);
  std::optional<Side> mesh;
  if (mesh_.channel) mesh = sides.front();
  wiring_.emplace(sides[sides.size() - 2], sides.back(), mesh, parameters_.mapping);
  for (const std::string& note : wiring_->notes()) log::info("{}", note);
  history_.now.displacement.assign(wiring_->n_unknowns(), 0.);
  history_.now.velocity.assign(wiring_->n_unknowns(), 0.);
  fluid_wall_ = history_.now.displacement;
}

void Coupler::check_places(const std::vector<Side>& sides) {
  const Side &fluid = sides[sides.size() - 2], &structure = sides.back();
  const bool nearest = parameters_.mapping.type != MappingParameters::Type::matched;
  if (const std::string text = problem_of_closed_fluid(fluid.interface, fluid.name); !text.empty())
    throw Error("{}", text);
  for (const Side& side : sides) {
    if (&side == &structure) continue;
    const PlaceReport report =
        judge_places(structure.interface, structure.name, side.interface, side.name, nearest);
    if (!report.problem.empty()) throw Error("{}", report.problem);
    for (const std::string& note : report.notes) log::warn("{}", note);
  }
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
  require_finite(last_given_, wiring_->fluid().interface, wiring_->fluid().interface.gives, fluid_.name());
  last_load_ = wiring_->to_structure(last_given_);
  structure_.send({Op::solve, {}, last_load_, 0, -1, ""});
  return wiring_->from_structure(structure_.receive().data);
}

std::optional<StepFailure> Coupler::attempt(const Step& step) {
  if (!diverged_.empty()) return StepFailure(diverged_, false);
  enter_(Phase::begin_step, step.time);
  for (Partner* p : everyone()) p->seconds = 0;
  try {
    solve(step);
  } catch (const SchemeFailure& failure) {
    return StepFailure(failure.what(), false);
  } catch (const SolveFailure& failure) {
    // What swings already is not saved by halving.
    const auto swings = oscillation_guard_.suspects(parameters_.scheme);
    if (swings && parameters_.on_divergence == CouplingParameters::OnDivergence::stop)
      return StepFailure(fmt::format("{} Before that, {}", failure.what(), *swings), false);
    return failure.what();
  }
  return {};
}

void Coupler::solve(const Step& step) {
  ask_all(everyone(), {Op::begin_step, step, {}, 0, -1, ""});
  enter_(Phase::solve, step.time);
  InterfaceState guess = predict(history_, step.dt, parameters_.predictor_order);
  const bool move_always = parameters_.scheme != Scheme::semi_implicit;
  const bool constant = parameters_.acceleration.type == AccelerationParameters::Type::constant;
  iteration_guard_.start_step();
  bool first = true;
  const FixedPointMap map = [&](const InterfaceState& x) {
    ++iterations_;
    const bool move_mesh = mesh_.channel && (first || move_always);
    first = false;
    return pass(x, move_mesh);
  };
  const IterationObserver observer = [&](int k, const Residual& residual, double omega) {
    monitor_->iteration(step, k, residual, omega);
    iteration_guard_.pass(residual.absolute, omega, constant);
  };
  ConvergenceParameters convergence = parameters_.convergence;
  if (parameters_.scheme == Scheme::explicit_) {
    // One pass, whatever its residual.
    convergence.max_iterations = 1;
    convergence.relative = std::numeric_limits<double>::infinity();
  }
  last_ = solve_fixed_point(std::move(guess), wiring_->dim(), map, convergence, *accelerator_, observer);
  last_dt_ = step.dt;
}

void Coupler::accept(double time, int output) {
  enter_(Phase::accept, {});
  const std::vector<double> before = history_.now.displacement;
  ask_all(everyone(), {Op::accept_step, {}, {}, time, output, ""});
  enter_(Phase::accept, time);
  // Each side's work is its load times the way of its own wall: the fluid's is where its last pass put it,
  // which in the explicit scheme is the guess.
  const auto increment = [&](const std::vector<double>& now, const std::vector<double>& old) {
    std::vector<double> result(now.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = now[i] - old[i];
    return result;
  };
  const Balance fluid =
      wiring_->fluid_balance(last_given_, wiring_->at_fluid(increment(last_.x.displacement, fluid_wall_)));
  const Balance structure =
      wiring_->structure_balance(last_load_, increment(last_.image.displacement, before));
  monitor_->balance(time, fluid, structure);
  fluid_wall_ = last_.x.displacement;
  history_.old_velocity = std::move(history_.now.velocity);
  history_.now = last_.image;
  history_.old_dt = last_dt_;
  const auto parted = work_guard_.accepted(fluid.work, structure.work, parameters_.scheme);
  auto reason = oscillation_guard_.accepted(history_.now.displacement, last_dt_, parameters_.scheme);
  if (!reason) reason = parted;
  if (!reason || !diverged_.empty()) return;
  if (parameters_.on_divergence == CouplingParameters::OnDivergence::stop)
    diverged_ = *reason;
  else if (!warned_)
    log::warn("t = {:g} s: {}", time, *reason);
  warned_ = true;
}

void Coupler::save(const std::filesystem::path& folder) {
  enter_(Phase::save, {});
  ask_all(everyone(), {Op::save, {}, {}, 0, -1, folder.string()});
  CheckpointWriter file(MPI_COMM_SELF, folder / "coupler.h5");
  file.write("displacement", history_.now.displacement);
  file.write("velocity", history_.now.velocity);
  file.write("old-velocity", history_.old_velocity);
  file.write_scalar("old-dt", history_.old_dt);
  file.write("fluid-wall", fluid_wall_);
  file.write("work", work_guard_.totals());
  accelerator_->save(file);
  file.close();
}

void Coupler::load() {
  enter_(Phase::load, {});
  CheckpointReader file(MPI_COMM_SELF, folders_.restart / "coupler.h5");
  file.read("displacement", history_.now.displacement);
  file.read("velocity", history_.now.velocity);
  history_.old_velocity = file.read("old-velocity");
  history_.old_dt = file.read_scalar("old-dt");
  file.read("fluid-wall", fluid_wall_);
  std::array<double, 4> work{};
  file.read("work", work);
  work_guard_.restore(work);
  accelerator_->load(file);
  const RunState state = read_run_state(folders_.restart);
  loop_.restart(state);
  ask_all(everyone(), {Op::load, {}, {}, state.time, -1, folders_.restart.string()});
  log::info("continues from {} at t = {:g} s", folders_.restart.string(), state.time);
}

void Coupler::finalise() {
  enter_(Phase::finalise, {});
  log::info("{}", monitor_->summary(loop_.halvings()));
  if (const WorkGuard::Verdict v = work_guard_.verdict(); !v.text.empty())
    v.sound ? log::info("{}", v.text) : log::warn("{}", v.text);
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
