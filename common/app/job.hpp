// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/app/case/case_file.hpp"
#include "common/app/case/roll_call.hpp"
#include "common/app/loop/simulation.hpp"
#include "common/app/watch/watch.hpp"

namespace couplet::app {

/// One program's place in a job that has passed its roll call.
struct Job {
  MPI_Comm comm = MPI_COMM_NULL;  ///< the ranks of this participant
  int rank = 0;
  std::string name;    ///< of this participant
  bool alone = false;  ///< a standalone run
  std::vector<Member> members;
  const config::Document* document = nullptr;
  SimulationParameters simulation;
  std::filesystem::path case_folder;               ///< folder of the YAML
  std::filesystem::path output_folder;             ///< <output>/<name>, made already
  std::filesystem::path checkpoints;               ///< <output>/checkpoints
  std::filesystem::path restart_folder;            ///< the checkpoint to continue from; empty: fresh start
  double restart_time;                             ///< its time [s]; NaN: fresh start
  std::vector<diagnostics::EffectChoice> choices;  ///< of `effects: auto`
  Watch* watch = nullptr;
  FaultInjection* faults = nullptr;

  /// Tells the other processes what this one does from now on.
  void enter(Phase phase) const {
    watch->enter(phase);
    faults->at(couplet::app::name(phase));
  }
  const Member* find(const std::string& participant) const;
  /// Intercommunicator between this participant and another; both call it, in an order that cannot deadlock:
  /// the coupler first, by order of members. Collective over both.
  MPI_Comm connect(const std::string& participant) const;
};

/// main() of any program of a job: questions (--check, --docs, ...) are answered at once; otherwise MPI comes
/// up, the roll is called, and `run` runs. One guard around it all reports what was thrown, once, and ends
/// the whole job. Returns the exit code: 0; 1 the run failed; 2 the configuration or the launch is wrong; 3 stopped by a
/// signal, saved; 4 done, but a finding of severity `wrong` was not accepted.
int run_job(int argc, char** argv, const Program& program, const std::function<int(const Job&)>& run);

}  // namespace couplet::app
