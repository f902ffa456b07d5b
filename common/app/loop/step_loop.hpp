// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/app/loop/simulation.hpp"
#include "common/coupling/participant.hpp"
#include "common/coupling/step_plan.hpp"
#include "common/io/checkpoint_set.hpp"

namespace couplet::app {

/// Why steps were halved. A cause that comes back again and again is not one that shorter steps cure: they only feed a run
/// whose answer is lost.
class HalvingCauses {
 public:
  /// So many halvings for one cause end a run. A cause begins anew where more than `calm_steps` steps were accepted since
  /// that are as long as the one that failed: it is over, as where a load has changed suddenly.
  static constexpr int most = 10, calm_steps = 16;

  /// dt [s] of the step.
  void accepted(double dt);
  /// How often this cause has halved a step, now included. Causes are the same where the first sentences differ by numbers only.
  int halved(const std::string& reason, double dt);
  /// "the pressure did not converge in # iterations".
  static std::string without_numbers(const std::string& reason);

 private:
  struct Count {
    int halvings = 0, good_steps = 0;
    double dt = 0;  // that failed [s]
  };
  std::map<std::string, Count> counts_;
};

/// Where a run stands at an accepted time; kept beside the participants' files in a checkpoint folder as
/// run.h5.
struct RunState {
  double time = 0;
  int outputs = 0;  ///< written so far
  std::array<double, 6> plan{};
};
inline constexpr const char* run_file = "run.h5";  ///< of a checkpoint
/// Written by rank 0, collective; read by each rank for itself.
void write_run_state(MPI_Comm comm, const std::filesystem::path& folder, const RunState& state);
RunState read_run_state(const std::filesystem::path& folder);

/// `folder` itself if it is a complete checkpoint, else the one in it that has gone furthest, whichever file is
/// the newest; throws Error if there is none. `tell`: a warning where the latest run has not gone as far as an
/// earlier one.
std::filesystem::path find_checkpoint(const std::filesystem::path& folder, bool tell = false);

/// Why a step was not solved, and whether a smaller one may be.
struct StepFailure {
  std::string reason;
  bool halving_helps = true;
  StepFailure(std::string why, bool helps = true)  // NOLINT: a plain reason is a failure
      : reason(std::move(why)), halving_helps(helps) {}
  StepFailure(const char* why) : reason(why) {}  // NOLINT
};

/// What a run does with a step: all calls collective over its communicator.
struct StepActions {
  /// Begins and solves the step; the reason if that failed, nothing if it was solved. State n stays as it is.
  std::function<std::optional<StepFailure>(const coupling::Step&)> attempt;
  /// The step becomes state n. `time`: its end; `output`: number of the output that is due, -1 for none.
  std::function<void(double time, int output)> accept;
  std::function<void(int output)> write_start;
  /// The run stops here: the state that was saved, as an output that a continued run drops and writes anew when it is due.
  std::function<void(double time, int output)> write_stop = [](double, int) {};
  std::function<void(const std::filesystem::path& folder)> save;
  /// Why no checkpoint could be continued from; empty: checkpoints are written.
  std::string stateless;
  /// After each accepted step: for the console.
  std::function<void(const coupling::Step&, double time)> report;
  /// Largest step that is advised now [s].
  std::function<double()> advised_dt = [] { return std::numeric_limits<double>::infinity(); };
};

/// Steps from the start (or the checkpoint's time) to the end: halving after failures, outputs and
/// checkpoints at nominal times. The same loop drives a participant alone and the coupled job.
class StepLoop {
 public:
  StepLoop(MPI_Comm comm, const SimulationParameters& simulation, coupling::Scheme scheme,
           std::filesystem::path checkpoints);
  /// Continues from this state instead of from the start. `from`: its checkpoint; those of the run that wrote it, up to that
  /// time, are from now on this run's, and go as its own do, if they lie in the same folder.
  void restart(const RunState& state, const std::filesystem::path& from = {});
  /// Runs to the end, or to the next accepted step after the job was asked to stop (Watch::stop_requested), which is
  /// saved and written. The text is empty if all went well, else it says at what time and why no step could be found; the
  /// state before that step was saved, unless the job is stateless.
  std::string run(const StepActions& actions);

  double time() const { return plan_.time(); }
  GlobalIndex steps() const { return plan_.steps_accepted(); }
  int halvings() const { return halvings_; }

 private:
  bool due(double interval) const;
  StepFailure seen_again(const StepFailure& failure, double dt);
  /// Gives the folder.
  std::filesystem::path checkpoint(const StepActions& actions);
  std::string stop(const StepActions& actions);
  /// Whether the run may take this set away when it is old.
  bool is_own(const io::FoundSet& set) const;
  std::string what_is_kept(const StepActions& actions) const;
  std::string give_up(const StepActions& actions, const coupling::Step& step, const StepFailure& failure);

  MPI_Comm comm_;
  SimulationParameters simulation_;
  coupling::Scheme scheme_;
  std::filesystem::path checkpoints_;
  std::string run_id_;  // on rank 0
  coupling::StepPlan plan_;
  HalvingCauses causes_;
  std::pair<double, std::string> first_failure_;  // of the step under way: dt [s] and reason; empty: none
  std::vector<std::string> continues_;            // ids of the runs before
  double continued_at_ = 0;
  int outputs_ = 0, halvings_ = 0;
  bool restarted_ = false, is_written_ = false;  // is_written_: the state now, as an output
};

}  // namespace couplet::app
