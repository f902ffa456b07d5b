// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/app/step_loop.hpp"
#include "common/app/watch.hpp"
#include "coupler/accelerator.hpp"
#include "coupler/fixed_point.hpp"
#include "coupler/guards.hpp"
#include "coupler/monitor.hpp"
#include "coupler/parameters.hpp"
#include "coupler/partners.hpp"
#include "coupler/wiring.hpp"

namespace couplet {

struct CouplerChannels {
  std::unique_ptr<Channel> fluid, structure, mesh;  ///< mesh may be empty
};

struct CouplerFolders {
  std::filesystem::path output;       ///< for residuals.csv and balance.csv
  std::filesystem::path checkpoints;  ///< of the whole job
  std::filesystem::path restart;      ///< the checkpoint to continue from; empty: fresh start
};

/// Drives fluid, structure and mesh mover from start to end: Dirichlet-Neumann coupling whose unknown is the
/// displacement of the structure's interface vertices at t^{n+1}.
class Coupler {
 public:
  Coupler(const CouplingParameters& parameters, const SimulationParameters& simulation,
          CouplerChannels channels, CouplerFolders folders);
  /// Called when the coupler turns to another phase, with the time if there is one.
  void on_phase(std::function<void(Phase, std::optional<double>)> callback) { enter_ = std::move(callback); }
  /// Initialises, runs, finalises. Returns an empty text, or why the run stopped before its end.
  std::string run();

  int steps() const { return loop_.steps(); }
  int halvings() const { return loop_.halvings(); }
  long iterations() const { return iterations_; }
  /// The accepted interface motion.
  const InterfaceState& interface_state() const { return history_.now; }

 private:
  void initialise();
  void load();
  void save(const std::filesystem::path& folder);
  std::optional<StepFailure> attempt(const Step& step);
  void solve(const Step& step);
  void check_places(const std::vector<Side>& sides);
  /// One pass: motion to mesh mover and fluid, load to the structure, its motion back.
  InterfaceState pass(const InterfaceState& x, bool move_mesh);
  void accept(double time, int output);
  void finalise();
  std::vector<Partner*> everyone();

  CouplingParameters parameters_;
  SimulationParameters simulation_;
  CouplerFolders folders_;
  Partner fluid_, structure_, mesh_;
  std::optional<Wiring> wiring_;
  std::optional<Monitor> monitor_;
  StepLoop loop_;
  std::unique_ptr<Accelerator> accelerator_;
  InterfaceHistory history_;
  FixedPointResult last_;            // of the step just solved
  Exchange last_load_, last_given_;  // to the structure and from the fluid in its last pass
  std::vector<double> fluid_wall_;   // displacement that the fluid had in the last accepted step
  IterationGuard iteration_guard_;
  OscillationGuard oscillation_guard_;
  WorkGuard work_guard_;
  std::string diverged_;  // empty: no guard has fired
  bool warned_ = false;
  double last_dt_ = 0;
  long iterations_ = 0;
  std::function<void(Phase, std::optional<double>)> enter_ = [](Phase, std::optional<double>) {};
};

}  // namespace couplet
