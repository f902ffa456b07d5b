// SPDX-License-Identifier: Apache-2.0
#include "common/app/step_loop.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

namespace fs = std::filesystem;

const char* const run_file = "run.h5";

/// Complete checkpoints in a folder, oldest first. By age, not by step: those of an earlier run that went
/// further are older than what this run writes.
std::vector<fs::path> complete_checkpoints(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename().string().starts_with("step-") && fs::exists(entry.path() / run_file))
      found.emplace_back(fs::last_write_time(entry.path() / run_file), entry.path());
  std::sort(found.begin(), found.end());
  std::vector<fs::path> paths;
  for (const auto& [time, path] : found) paths.push_back(path);
  return paths;
}

}  // namespace

void write_run_state(MPI_Comm comm, const fs::path& folder, const RunState& state) {
  if (comm_rank(comm) == 0) {
    CheckpointWriter file(MPI_COMM_SELF, folder / run_file);
    file.write_scalar("time", state.time);
    file.write_scalar("outputs", state.outputs);
    file.write("plan", state.plan);
    file.close();
  }
  MPI_Barrier(comm);
}

RunState read_run_state(const fs::path& folder) {
  CheckpointReader file(MPI_COMM_SELF, folder / run_file);
  RunState state;
  state.time = file.read_scalar("time");
  state.outputs = int(file.read_scalar("outputs"));
  file.read("plan", state.plan);
  return state;
}

fs::path find_checkpoint(const fs::path& folder) {
  if (fs::exists(folder / run_file)) return folder;
  const std::vector<fs::path> found = complete_checkpoints(folder);
  if (found.empty())
    throw Error(
        "--restart {}: there is no complete checkpoint. Give a folder made by an earlier run, such as "
        "out/checkpoints/step-00000100, or the folder above it for the latest one.",
        folder.string());
  return found.back();
}

StepLoop::StepLoop(MPI_Comm comm, const SimulationParameters& simulation, Scheme scheme, fs::path checkpoints)
    : comm_(comm),
      simulation_(simulation),
      scheme_(scheme),
      checkpoints_(std::move(checkpoints)),
      plan_(simulation.end_time, simulation.time_step, simulation.max_step_halvings) {}

void StepLoop::restart(const RunState& state) {
  plan_.restore(state.plan, state.time);
  outputs_ = state.outputs;
  restarted_ = true;
}

bool StepLoop::due(double interval) const {
  if (plan_.finished()) return true;
  if (interval <= 0) return false;
  // Due when a multiple of the interval lies in the nominal step that has just ended.
  const auto multiples = [&](double t) {
    return std::floor(t / interval + 1e-9 * simulation_.time_step / interval);
  };
  return multiples(plan_.time()) > multiples(plan_.time() - simulation_.time_step);
}

void StepLoop::checkpoint(const StepActions& actions) {
  const fs::path folder = checkpoints_ / fmt::format("step-{:08d}", plan_.steps_accepted());
  std::error_code failed;
  if (comm_rank(comm_) == 0) {
    fs::remove(folder / run_file, failed);
    fs::create_directories(folder, failed);
  }
  if (any(comm_, bool(failed)))
    throw Error("The checkpoint folder {} could not be made: {}.", folder.string(), failed.message());
  actions.save(folder);
  write_run_state(comm_, folder, {plan_.time(), outputs_, plan_.state()});
  log::debug("checkpoint {} at t = {:g} s", folder.string(), plan_.time());
  if (comm_rank(comm_) != 0) return;
  const std::vector<fs::path> all = complete_checkpoints(checkpoints_);
  for (std::size_t i = 0; i + simulation_.checkpoints_kept < all.size(); ++i) fs::remove_all(all[i], failed);
}

std::string StepLoop::give_up(const StepActions& actions, const Step& step, const StepFailure& failure) {
  checkpoint(actions);
  if (!failure.halving_helps)
    return fmt::format("The run ends at t = {:g} s: {} The state at t = {:g} s was saved in {}.", step.time,
                       failure.reason, step.time, checkpoints_.string());
  return fmt::format(
      "The step from t = {:g} s could not be solved, also not with dt = {:g} s after {} halvings: {} The "
      "state at t = "
      "{:g} s was saved in {}.",
      step.time, step.dt, plan_.halvings(), failure.reason, step.time, checkpoints_.string());
}

std::string StepLoop::run(const StepActions& actions) {
  if (!restarted_) actions.write_start(outputs_++);
  while (!plan_.finished()) {
    plan_.limit(actions.advised_dt());
    const Step step{plan_.time(), plan_.dt(), scheme_, plan_.steps_accepted(), plan_.is_last()};
    if (const auto failure = actions.attempt(step)) {
      log::warn("t = {:g} s: step {} with dt = {:g} s failed: {}", step.time, step.number + 1, step.dt,
                failure->reason);
      if (!failure->halving_helps) return give_up(actions, step, *failure);
      ++halvings_;
      if (!plan_.halve()) return give_up(actions, step, *failure);
      continue;
    }
    plan_.accepted();
    const bool output = plan_.at_nominal_time() && due(simulation_.output_interval);
    actions.accept(plan_.time(), output ? outputs_++ : -1);
    actions.report(step, plan_.time());
    if (plan_.at_nominal_time() && due(simulation_.checkpoint_interval)) checkpoint(actions);
  }
  return "";
}

}  // namespace couplet
