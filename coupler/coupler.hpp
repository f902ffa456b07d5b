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
#include "common/app/supervision/supervisor.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "coupler/acceleration/accelerator.hpp"
#include "coupler/acceleration/unknown.hpp"
#include "coupler/diagnostics/view.hpp"
#include "coupler/output/record.hpp"
#include "coupler/parameters/parameters.hpp"
#include "coupler/parameters/schedule.hpp"
#include "coupler/pass.hpp"

namespace couplet::coupler {

struct CouplerFolders {
  std::filesystem::path output;       ///< for the coupler's own files
  std::filesystem::path checkpoints;  ///< of the whole job
  std::filesystem::path restart;      ///< checkpoint to continue from; empty for a fresh start
};

/// Drives any number of participants from start to end. A step is a fixed-point problem x = H(x), where H is
/// one Pass and x the exchanged data (Unknown): predict, pass, accelerate until convergence, accept. All
/// ranks of the coupler do the same with their parts of the interfaces.
class Coupler {
 public:
  /// `channels`: channels to all participants of the schedule, in any order.
  Coupler(MPI_Comm comm, const CouplingParameters& parameters, const app::SimulationParameters& simulation,
          std::vector<std::unique_ptr<coupling::Channel>> channels, CouplerFolders folders);
  /// Sets a callback for changes of phase, with the time if there is one.
  void on_phase(std::function<void(app::Phase, std::optional<double>)> callback) {
    enter_ = std::move(callback);
  }
  /// Initializes, runs and finalizes. Returns an empty text, or why the run stopped early.
  std::string run();

  GlobalIndex steps() const { return loop_.steps(); }
  double time() const { return loop_.time(); }
  int halvings() const { return loop_.halvings(); }
  long iterations() const { return iterations_; }
  /// Error budget of the whole job, after a successful end.
  const diagnostics::ErrorParts& errors() const { return errors_; }
  /// Position of the job on the maps of the coupling.
  std::vector<diagnostics::Coordinate> position() const;
  const coupling::Exchange& given_by(const std::string& name) const {
    return pass_.given()[pass_.index_of(name)];
  }

 private:
  void initialise();
  std::optional<app::StepFailure> attempt(const coupling::Step& step);
  std::optional<app::StepFailure> attempt_once(const coupling::Step& step);
  /// Solves x = H(x) for the step from t^n to t^n + dt. Participants keep their state n.
  void solve(const coupling::Step& step);
  void accept(double time, int output);

  // coupler/step: one step.
  /// Explicit coupling. Results of additional passes only go to the diagnostics.
  FixedPointResult single_pass(const coupling::Step& step);
  void measure_response(const coupling::Step& step, FixedPointResult& result);
  /// Passes and accelerated guesses until all residuals are below their bounds. Throws SolveFailure.
  FixedPointResult iterate(const coupling::Step& step);
  void observe(const coupling::Step& step, int number, const std::vector<Residual>& residuals);
  Iterate pass(const Iterate& x);
  Iterate pass_from(std::vector<coupling::Exchange> data);
  Iterate guess(double dt);
  std::vector<Residual> measure(const Iterate& x, const Iterate& image) const;
  bool has_history() const;
  Iterate first_pass();

  /// Forgets what was learned from passes of another kind.
  void start_acceleration();
  app::StepFailure cause_of(const std::string& reported) const;
  void visit(io::Archive archive);
  void save(const std::filesystem::path& folder);
  void load();
  void finalise(const std::string& problem);

  MPI_Comm comm_;
  CouplingParameters parameters_;
  app::SimulationParameters simulation_;
  CouplerFolders folders_;
  app::StepLoop loop_;
  Pass pass_;
  SchemeChoice scheme_;
  std::unique_ptr<Accelerator> accelerator_;  // nullptr with one pass per step
  CouplingHistory history_;                   // of accepted steps; empty until all data have been given
  FixedPointResult last_;                     // of the step just solved
  double last_dt_ = 0;
  long iterations_ = 0;
  diagnostics::Diagnostics diagnostics_;
  // Created once the interfaces are known.
  std::optional<Unknown> unknown_;
  std::optional<Record> record_;
  std::optional<CouplingView> view_;
  CouplingDiagnostics coupling_diagnostics_;
  diagnostics::ErrorParts errors_;
  std::function<void(app::Phase, std::optional<double>)> enter_ = [](app::Phase, std::optional<double>) {};
};

}  // namespace couplet::coupler
