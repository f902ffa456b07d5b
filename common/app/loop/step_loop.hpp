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
#include <vector>

#include "common/config/section.hpp"
#include "common/coupling/participant.hpp"
#include "common/coupling/step_plan.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/io/fields/mesh_part.hpp"
#include "common/time/steadiness.hpp"

namespace couplet::app {

/// Parameters of `simulation:` in the YAML for every program.
struct SimulationParameters {
  std::string name = "case";
  double end_time = 0, time_step = 0;  // [s]
  int max_step_halvings = 6;           // halvings of a failed step
  std::vector<std::string> accept;     // ids of findings that do not cause exit code 4
  double neglected_share = 0.05;       // of the result, from which a neglected effect matters
  std::string output_folder = "out";   // relative to the YAML's folder unless absolute
  std::optional<double> until_steady;  // estimated relative distance from the steady state that ends the run
  double output_interval = 0;          // [s]; 0 means only at the start and at the end
  bool output_steps = true;            // steps.csv
  io::FieldChoice fields;              // volume fields
  double checkpoint_interval = 0;      // [s]; 0 for only at the end
  int checkpoints_kept = 2;
  double hang_timeout = 600;  // [s]; 0 for never
  diagnostics::When diagnostics = diagnostics::When::with_errors;
  bool choose_effects = false;  // estimates of the scene decide what the case leaves open
  std::string keys;             // case as text, stored with every checkpoint (see case_keys)
};
void declare(config::Section& section, SimulationParameters& parameters);

/// Counts the causes of step halvings. Shorter steps cannot cure a recurring cause; they only prolong a run
/// whose result is lost.
class HalvingCauses {
 public:
  /// Number of halvings by one cause that ends a run. A cause is forgotten after more than `calm_steps`
  /// accepted steps that are at least as long as the failed one, for example after a sudden change of load.
  static constexpr int most = 10, calm_steps = 16;

  /// Registers an accepted step of length dt [s].
  void accepted(double dt);
  /// Registers a halving and counts its cause. Causes are equal if their first sentences differ only in
  /// numbers.
  int halved(const std::string& reason, double dt);
  /// Returns "the pressure did not converge in # iterations".
  static std::string without_numbers(const std::string& reason);

 private:
  struct Count {
    int halvings = 0, good_steps = 0;
    double dt = 0;  // of the failed step [s]
  };
  std::map<std::string, Count> counts_;
};

/// State of a run at an accepted time, stored as run.h5 beside the participants' files in a checkpoint.
struct RunState {
  double time = 0;
  int outputs = 0;  ///< number of outputs written
  std::array<double, 6> plan{};
  time::Steadiness steadiness{};
};
inline constexpr const char* run_file = "run.h5";  ///< in a checkpoint
/// Rank 0 writes the state (collective). Each rank reads it by itself.
void write_run_state(MPI_Comm comm, const std::filesystem::path& folder, RunState state);
RunState read_run_state(const std::filesystem::path& folder);

/// Returns `folder` if it is a complete checkpoint, else the one in it with the latest time, regardless of
/// file dates. Throws Error if there is none. `tell` warns if the latest run did not get as far as an earlier
/// one.
std::filesystem::path find_checkpoint(const std::filesystem::path& folder, bool tell = false);

/// Reason why a step failed, and whether a smaller one may succeed.
struct StepFailure {
  std::string reason;
  bool halving_helps = true;
  StepFailure(std::string why, bool helps = true)  // NOLINT: a plain reason is a failure
      : reason(std::move(why)), halving_helps(helps) {}
  StepFailure(const char* why) : reason(why) {}  // NOLINT
};

/// Actions of a run for each step. All calls are collective over its communicator.
struct StepActions {
  /// Begins and solves the step without changing state n. Returns the reason of a failure, or nothing.
  std::function<std::optional<StepFailure>(const coupling::Step&)> attempt;
  /// Makes the step state n. `time` is its end, `output` the number of the output that is due, or -1.
  std::function<void(double time, int output)> accept;
  std::function<void(int output)> write_start;
  /// Writes the saved state as output of a stopped run. A continued run replaces it by regular output.
  std::function<void(double time, int output)> write_stop = [](double, int) {};
  std::function<void(const std::filesystem::path& folder)> save;
  /// Reason why no checkpoint could be continued. If empty, checkpoints are written.
  std::string stateless;
  /// Reports an accepted step on the console.
  std::function<void(const coupling::Step&, double time)> report;
  /// Largest currently recommended step [s].
  std::function<double()> advised_dt = [] { return std::numeric_limits<double>::infinity(); };
  /// Largest relative change of a program in the last accepted step, with `until-steady`; NaN if none tells.
  std::function<double()> change = [] { return coupling::StepReport::unknown; };
};

/// Advances from the start (or the checkpoint) to the end: halves failed steps, and writes outputs and
/// checkpoints at nominal times. It drives standalone participants and coupled jobs.
class StepLoop {
 public:
  StepLoop(MPI_Comm comm, const SimulationParameters& simulation, coupling::Scheme scheme,
           std::filesystem::path checkpoints);
  /// Continues from this state. `from` is its checkpoint. Earlier checkpoints of that run in the same folder
  /// then belong to this run and are removed like its own.
  void restart(const RunState& state, const std::filesystem::path& from = {});
  /// Runs to the end, or after a stop request (Supervisor::stop_requested) to the next accepted step, which is
  /// saved and written. Returns an empty text on success. Otherwise it states when and why no step was found;
  /// the state before was saved unless the job is stateless.
  std::string run(const StepActions& actions);

  double time() const { return plan_.time(); }
  GlobalIndex steps() const { return plan_.steps_accepted(); }
  int halvings() const { return halvings_; }

 private:
  bool due(double interval) const;
  /// True if the accepted step has brought the run close enough to a steady state. Collective.
  bool is_steady(double change, double dt);
  StepFailure seen_again(const StepFailure& failure, double dt);
  /// Writes a checkpoint and returns its folder.
  std::filesystem::path checkpoint(const StepActions& actions);
  std::string stop(const StepActions& actions);
  /// Returns true if the run may remove this set when it is old.
  bool is_own(const io::FoundSet& set) const;
  std::string what_is_kept(const StepActions& actions) const;
  std::string give_up(const StepActions& actions, const coupling::Step& step, const StepFailure& failure);

  MPI_Comm comm_;
  SimulationParameters simulation_;
  coupling::Scheme scheme_;
  std::filesystem::path checkpoints_;
  std::string run_id_;  // on rank 0
  coupling::StepPlan plan_;
  time::Steadiness steadiness_;
  HalvingCauses causes_;
  std::pair<double, std::string> first_failure_;  // of the current step: dt [s] and reason; empty if none
  std::vector<std::string> continues_;            // ids of the earlier runs
  double continued_at_ = 0;
  int outputs_ = 0, halvings_ = 0;
  bool restarted_ = false, is_written_ = false;  // is_written_: the current state was written as output
};

}  // namespace couplet::app
