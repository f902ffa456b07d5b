// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/app/loop/step_loop.hpp"
#include "common/app/watch/watch.hpp"
#include "coupler/acceleration/accelerator.hpp"
#include "coupler/acceleration/fixed_point.hpp"
#include "coupler/acceleration/unknown.hpp"
#include "coupler/acceleration/volume_level.hpp"
#include "coupler/exchange/partners.hpp"
#include "coupler/judge/audit.hpp"
#include "coupler/judge/data_guard.hpp"
#include "coupler/judge/error_estimate.hpp"
#include "coupler/judge/guards.hpp"
#include "coupler/judge/lag_estimate.hpp"
#include "coupler/judge/mechanics.hpp"
#include "coupler/judge/scheme_choice.hpp"
#include "coupler/judge/still_guard.hpp"
#include "coupler/output/interface_output.hpp"
#include "coupler/output/monitor.hpp"
#include "coupler/output/watch_integrals.hpp"
#include "coupler/parameters/parameters.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

struct CouplerFolders {
  std::filesystem::path output;       ///< for the coupler's own files
  std::filesystem::path checkpoints;  ///< of the whole job
  std::filesystem::path restart;      ///< the checkpoint to continue from; empty: fresh start
};

/// Channels by role, for callers without configuration: the roles take the channels' names.
struct CouplerChannels {
  std::unique_ptr<coupling::Channel> fluid, structure, mesh;  ///< mesh may be empty
};

/// Drives any number of participants from start to end: Links say who gives what to whom, the Schedule in
/// which order and how often, the Accelerator how the next guess follows. All its ranks do the same with
/// their own parts of the interfaces.
class Coupler {
 public:
  /// `channels`: to everyone of the schedule, in any order.
  Coupler(MPI_Comm comm, const CouplingParameters& parameters, const app::SimulationParameters& simulation,
          std::vector<std::unique_ptr<coupling::Channel>> channels, CouplerFolders folders);
  /// In one process.
  Coupler(const CouplingParameters& parameters, const app::SimulationParameters& simulation,
          CouplerChannels channels, CouplerFolders folders);
  /// Called when the coupler turns to another phase, with the time if there is one.
  void on_phase(std::function<void(app::Phase, std::optional<double>)> callback) {
    enter_ = std::move(callback);
  }
  /// Initialises, runs, finalises. Returns an empty text, or why the run stopped before its end.
  std::string run();

  GlobalIndex steps() const { return loop_.steps(); }
  double time() const { return loop_.time(); }
  int halvings() const { return loop_.halvings(); }
  long iterations() const { return iterations_; }
  /// The budget of the whole job, once it has ended well.
  const coupling::ErrorParts& errors() const { return found_; }
  /// Where the job stands on the maps of the coupling.
  std::vector<effects::Coordinate> position() const;
  /// What each has given in the last pass, in the order of the schedule's everyone().
  const std::vector<coupling::Exchange>& given() const { return given_; }
  const coupling::Exchange& given_by(const std::string& name) const { return given_[index_of(name)]; }

 private:
  std::size_t index_of(const std::string& name) const;
  std::vector<Partner*> everyone();
  void initialise();
  /// Values before the first step: from those that gave any, to those, and as the first guess.
  void exchange_initial_values();
  void load();
  void save(const std::filesystem::path& folder);
  parallel::GlobalOrder order_of_wall(std::size_t i) const;
  std::optional<app::StepFailure> attempt(const coupling::Step& step);
  std::optional<app::StepFailure> attempt_once(const coupling::Step& step);
  void map_changed();
  /// Forgets what was learnt of other passes than those that follow.
  void start_acceleration();
  /// Why a step failed: what the coupling itself does comes before what a participant reports.
  app::StepFailure cause_of(const std::string& reported) const;
  void solve(const coupling::Step& step);
  /// One pass from x, the explicit scheme's step.
  void pass_once(const coupling::Step& step, const FixedPointMap& map);
  /// Where values within the step are asked for: the first pass, whose times they are iterated on at from then on.
  std::optional<Iterate> look_within(const FixedPointMap& map);
  /// What comes back in a step half as long, of some steps of explicit coupling before they begin.
  void look_at_lag(coupling::Step step);
  /// One pass through the group from what is known to what all give.
  std::vector<coupling::Exchange> pass(std::vector<coupling::Exchange> known, bool first);
  void ask(std::size_t i, const std::vector<coupling::Exchange>& known, bool move_mesh);
  void guess_motion(const std::vector<coupling::Exchange>& known, bool first);
  void answer(std::size_t i, coupling::Exchange& given, bool move_mesh);
  /// To the channels, for the next replies.
  void give_back(std::vector<coupling::Exchange> given);
  void hold_volume(std::size_t i, std::vector<coupling::Exchange>& known);
  void accept(double time, int output);
  /// A step that `at-max-iterations: accept` takes as it is: the first one, and each that is ten times worse, is a finding.
  void report_unconverged(double time);
  void watch(double time, const std::vector<SideBalance>& balances);
  void finalise(const std::string& problem);
  void tell_work() const;
  void tell_errors(std::vector<coupling::NamedErrors> participants);

  MPI_Comm comm_;
  CouplingParameters parameters_;
  app::SimulationParameters simulation_;
  Schedule schedule_;
  CouplerFolders folders_;
  std::vector<Partner> partners_;   // in the order of the schedule's everyone()
  std::vector<std::size_t> group_;  // of these
  std::vector<Side> sides_;
  std::optional<Links> links_;
  std::optional<Unknown> unknown_;
  std::optional<VolumeLevel> volume_level_;  // none: no closed fluid asks for it
  std::optional<Mechanics> mechanics_;
  std::optional<Monitor> monitor_;
  std::optional<InterfaceOutput> interface_output_;  // none: not asked for
  std::optional<WatchIntegrals> watched_;            // the same
  app::StepLoop loop_;
  std::unique_ptr<Accelerator> accelerator_;  // none: one pass a step
  History history_;                           // of accepted steps; empty before all has been given
  SchemeChoice scheme_;
  FixedPointResult last_;                          // of the step just solved
  std::vector<coupling::Exchange> given_, taken_;  // by each in its last pass
  coupling::Exchange guess_;                       // of the motion, that the mover has been given
  IterationGuard iteration_guard_;
  OscillationGuard oscillation_guard_;
  WorkGuard work_guard_;
  std::optional<StillGuard> still_guard_;
  std::optional<DataGuard> data_guard_;
  std::optional<CouplingAudit> audit_;
  std::optional<CouplingErrorEstimate> errors_;  // none: not wanted, or nothing is iterated
  std::optional<LagEstimate> lag_;               // none: not wanted, not explicit, or it could not tell
  std::optional<LagEstimate::Look> half_;        // of the step under way; none: it is not looked at
  coupling::ErrorParts found_;                   // of all participants, at the end
  std::string diverged_;                         // empty: no guard has fired
  double worst_accepted_ = 0;                    // relative residual of a step that was accepted unconverged
  bool warned_ = false;
  bool answered_anew_ = false;  // somebody in the last pass
  double last_dt_ = 0;
  long iterations_ = 0;
  int passes_ = 0;  // of the step under way
  std::function<void(app::Phase, std::optional<double>)> enter_ = [](app::Phase, std::optional<double>) {};
};

}  // namespace couplet::coupler
