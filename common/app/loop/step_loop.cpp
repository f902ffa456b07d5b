// SPDX-License-Identifier: Apache-2.0
#include "common/app/loop/step_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

#include "common/app/supervision/supervisor.hpp"
#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::app {

void HalvingCauses::accepted(double dt) {
  for (auto& [cause, count] : counts_) count.good_steps += dt >= (1 - 1e-9) * count.dt;
}

int HalvingCauses::halved(const std::string& reason, double dt) {
  const std::string cause = without_numbers(reason);
  Count& count = counts_[cause.substr(0, cause.find(". "))];
  if (count.good_steps > calm_steps) count.halvings = 0;
  count.good_steps = 0;
  count.dt = dt;
  return ++count.halvings;
}

std::string HalvingCauses::without_numbers(const std::string& reason) {
  const auto digit = [&](std::size_t i) {
    return i < reason.size() && std::isdigit(static_cast<unsigned char>(reason[i]));
  };
  const auto sign = [&](std::size_t i) {
    return i < reason.size() && (reason[i] == '-' || reason[i] == '+');
  };
  std::string text;
  for (std::size_t i = 0; i < reason.size();) {
    if (!digit(i)) {
      text += reason[i++];
      continue;
    }
    if (!text.empty() && text.back() == '-') text.pop_back();
    while (digit(i) || (i < reason.size() && reason[i] == '.' && digit(i + 1)) ||
           (i < reason.size() && reason[i] == 'e' && (digit(i + 1) || (sign(i + 1) && digit(i + 2)))) ||
           (sign(i) && reason[i - 1] == 'e'))
      ++i;
    text += '#';
  }
  return text;
}

namespace {

namespace fs = std::filesystem;

// Offset of outputs written by a stop, so that a continued run drops those later than its checkpoint.
constexpr double later_than_saved = 1 + 4e-9;

/// Creates a unique id for each run in a folder. Later runs have larger ones.
std::string make_run_id() {
  std::random_device device;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  return fmt::format("{:012x}-{:08x}", milliseconds, device());
}

/// Runs `action` on rank 0 and throws its Error on every rank. Collective.
void on_first_rank(MPI_Comm comm, const std::function<void()>& action) {
  std::string problem;
  if (parallel::comm_rank(comm) == 0) {
    try {
      action();
    } catch (const std::exception& error) {
      problem = error.what();
    }
  }
  parallel::broadcast(comm, problem);
  if (!problem.empty()) throw Error("{}", problem);
}

void visit(io::Archive archive, RunState& state) {
  archive.common("run", state.time, state.outputs, state.plan, state.steadiness);
}

}  // namespace

void write_run_state(MPI_Comm comm, const fs::path& folder, RunState state) {
  if (parallel::comm_rank(comm) == 0) {
    io::CheckpointWriter file(MPI_COMM_SELF, folder / run_file);
    visit(io::Archive(file), state);
    file.close();
  }
  MPI_Barrier(comm);
}

RunState read_run_state(const fs::path& folder) {
  io::CheckpointReader file(MPI_COMM_SELF, folder / run_file);
  RunState state;
  visit(io::Archive(file), state);
  return state;
}

fs::path find_checkpoint(const fs::path& folder, bool tell) {
  if (io::read_checkpoint_set(folder)) return folder;
  const std::vector<io::FoundSet> found = io::checkpoint_sets(folder);
  if (found.empty())
    throw Error(
        "--restart {}: no complete checkpoint found. Give a checkpoint folder of an earlier run, such as "
        "out/checkpoints/step-00000100, or its parent folder for the latest one.",
        folder.string());
  const io::FoundSet& furthest = found.back();
  const io::FoundSet& latest = *std::ranges::max_element(
      found, {}, [](const io::FoundSet& set) { return std::tie(set.stamp.run, set.stamp.time); });
  if (tell && latest.stamp.run > furthest.stamp.run)
    log::warn(
        "--restart {}: {}, the last one of the latest run (t = {:g} s), is used. To use {} of an earlier run "
        "(t = {:g} s), give its folder.",
        folder.string(), latest.folder.filename().string(), latest.stamp.time,
        furthest.folder.filename().string(), furthest.stamp.time);
  return latest.folder;
}

StepLoop::StepLoop(MPI_Comm comm, const SimulationParameters& simulation, coupling::Scheme scheme,
                   fs::path checkpoints)
    : comm_(comm),
      simulation_(simulation),
      scheme_(scheme),
      checkpoints_(std::move(checkpoints)),
      run_id_(parallel::comm_rank(comm) == 0 ? make_run_id() : ""),
      plan_(simulation.end_time, simulation.time_step, simulation.max_step_halvings) {}

void StepLoop::restart(const RunState& state, const fs::path& from) {
  std::error_code unknown;
  if (!from.empty() &&
      fs::equivalent(from.parent_path().empty() ? "." : from.parent_path(), checkpoints_, unknown))
    if (const auto set = io::read_checkpoint_set(from)) {
      continues_ = set->continues;
      continues_.push_back(set->stamp.run);
      continued_at_ = set->stamp.time;
    }
  plan_.restore(state.plan, state.time);
  outputs_ = state.outputs;
  steadiness_ = state.steadiness;
  restarted_ = true;
}

bool StepLoop::due(double interval) const {
  if (plan_.finished()) return true;
  if (interval <= 0) return false;
  // Due if a multiple of the interval lies in the nominal step that just ended.
  const auto multiples = [&](double t) {
    const double rounding = std::max(1e-9 * simulation_.time_step, 4e-16 * plan_.time());
    return std::floor((t + rounding) / interval);
  };
  return multiples(plan_.time()) > multiples(plan_.time() - simulation_.time_step);
}

bool StepLoop::is_steady(double change, double dt) {
  if (!simulation_.until_steady) return false;
  if (std::isnan(change)) {
    if (plan_.finished() && parallel::comm_rank(comm_) == 0)
      log::warn(
          "'until-steady' had no effect: no program of this run tells how much a step changes its solution");
    return false;
  }
  steadiness_.add(change, dt);
  const double left = steadiness_.left();
  const bool reached = parallel::any(comm_, left <= *simulation_.until_steady);
  if (parallel::comm_rank(comm_) != 0) return reached;
  if (reached)
    log::info("t = {:g} s: steady; what is left of the way there is estimated as {:.2g} of the solution",
              plan_.time(), left);
  else if (plan_.finished() && std::isinf(left))
    log::warn("t = {:g} s: too few equal steps to tell whether it is steady ('until-steady')", plan_.time());
  else if (plan_.finished())
    log::warn(
        "t = {:g} s: not steady ('until-steady: {:g}'): what is left of the way there is estimated as {}",
        plan_.time(), *simulation_.until_steady,
        left < 1 ? fmt::format("{:.2g} of the solution", left) : "more than the solution itself");
  return reached;
}

bool StepLoop::is_own(const io::FoundSet& set) const {
  return set.stamp.run == run_id_ || (set.stamp.time <= continued_at_ &&
                                      std::ranges::find(continues_, set.stamp.run) != continues_.end());
}

fs::path StepLoop::checkpoint(const StepActions& actions) {
  if (!actions.stateless.empty()) return {};
  const io::CheckpointStamp stamp{run_id_, plan_.steps_accepted(), plan_.time()};
  std::string name;
  on_first_rank(comm_, [&] { name = io::begin_checkpoint_set(checkpoints_, stamp).string(); });
  parallel::broadcast(comm_, name);
  const fs::path folder = name;
  actions.save(folder);
  write_run_state(comm_, folder, {plan_.time(), outputs_, plan_.state(), steadiness_});
  on_first_rank(comm_, [&] {
    base::write_file(folder / "keys.txt", simulation_.keys, true);
    io::finish_checkpoint_set(folder, stamp, continues_);
    log::debug("checkpoint {} at t = {:g} s", folder.string(), plan_.time());
    // Keeps sets of other runs.
    std::vector<io::FoundSet> own = io::checkpoint_sets(checkpoints_);
    std::erase_if(own, [&](const io::FoundSet& set) { return !is_own(set); });
    for (std::size_t i = 0; i + simulation_.checkpoints_kept < own.size(); ++i)
      io::remove_checkpoint_set(own[i].folder);
  });
  return folder;
}

std::string StepLoop::stop(const StepActions& actions) {
  const fs::path folder = checkpoint(actions);
  // Written after the checkpoint, because participants may change their state when writing output.
  if (!is_written_) actions.write_stop(plan_.time() * later_than_saved, outputs_);
  if (folder.empty())
    return fmt::format("Stopped at t = {:g} s by a signal.{}", plan_.time(), what_is_kept(actions));
  Supervisor::stopped();
  if (parallel::comm_rank(comm_) == 0)
    log::info("stopped at t = {:g} s by a signal; the state is saved: continue with --restart {}",
              plan_.time(), folder.string());
  return "";
}

std::string StepLoop::what_is_kept(const StepActions& actions) const {
  if (!actions.stateless.empty()) return fmt::format(" No state was saved: {}.", actions.stateless);
  return fmt::format(" The state at t = {:g} s was saved in {}.", plan_.time(), checkpoints_.string());
}

std::string StepLoop::give_up(const StepActions& actions, const coupling::Step& step,
                              const StepFailure& failure) {
  checkpoint(actions);
  if (!failure.halving_helps)
    return fmt::format("The run ends at t = {:g} s: {}{}", step.time, failure.reason, what_is_kept(actions));
  const auto& [first_dt, first] = first_failure_;
  // The last failure may occur only with short steps.
  const bool is_another =
      HalvingCauses::without_numbers(first) != HalvingCauses::without_numbers(failure.reason);
  return fmt::format("The step from t = {:g} s failed, even with dt = {:g} s after {} halvings: {}{}{}",
                     step.time, step.dt, plan_.halvings(), failure.reason,
                     is_another ? fmt::format(" It failed first with dt = {:g} s: {}", first_dt, first) : "",
                     what_is_kept(actions));
}

/// Returns the failure itself, or why the run ends if its cause has halved steps too often. Collective,
/// because ranks may word a cause differently.
StepFailure StepLoop::seen_again(const StepFailure& failure, double dt) {
  const GlobalIndex mine = parallel::comm_rank(comm_) == 0 ? causes_.halved(failure.reason, dt) : 0,
                    times = parallel::sum(comm_, mine);
  if (times < HalvingCauses::most) return failure;
  return {fmt::format("{} halvings of the step for one cause did not help: {}", times, failure.reason),
          false};
}

std::string StepLoop::run(const StepActions& actions) {
  on_first_rank(comm_, [&] {
    for (const fs::path& folder : io::clear_incomplete_sets(checkpoints_))
      log::info("removed the incomplete checkpoint {} of an earlier run", folder.string());
  });
  if (!restarted_) actions.write_start(outputs_++), is_written_ = true;
  while (!plan_.finished()) {
    if (parallel::any(comm_, Supervisor::stop_requested())) return stop(actions);
    plan_.limit(actions.advised_dt());
    const coupling::Step step{.time = plan_.time(),
                              .dt = plan_.dt(),
                              .scheme = scheme_,
                              .number = plan_.steps_accepted(),
                              .is_last = plan_.is_last()};
    if (const auto failure = actions.attempt(step)) {
      if (failure->reason.empty()) return "";  // the participants have ended the run by themselves
      if (parallel::comm_rank(comm_) == 0)
        log::warn("t = {:g} s: step {} with dt = {:g} s failed: {}", step.time, step.number + 1, step.dt,
                  failure->reason);
      if (!failure->halving_helps) return give_up(actions, step, *failure);
      if (first_failure_.second.empty()) first_failure_ = {step.dt, failure->reason};
      ++halvings_;
      if (const StepFailure again = seen_again(*failure, step.dt); !again.halving_helps)
        return give_up(actions, step, again);
      if (!plan_.halve()) return give_up(actions, step, *failure);
      continue;
    }
    plan_.accepted();
    causes_.accepted(step.dt);
    first_failure_ = {};
    const bool output = plan_.at_nominal_time() && due(simulation_.output_interval);
    actions.accept(plan_.time(), output ? outputs_++ : -1);
    is_written_ = output;
    actions.report(step, plan_.time());
    const bool steady = is_steady(actions.change(), step.dt);
    if (steady || (plan_.at_nominal_time() && due(simulation_.checkpoint_interval))) checkpoint(actions);
    if (!steady) continue;
    if (!is_written_) actions.write_stop(plan_.time(), outputs_);
    break;
  }
  return "";
}

}  // namespace couplet::app
