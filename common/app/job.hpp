// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/app/case/case_file.hpp"
#include "common/app/case/roll_call.hpp"
#include "common/app/loop/step_loop.hpp"
#include "common/app/supervision/supervisor.hpp"

namespace couplet::app {

/// State of one program in a job after the roll call.
struct Job {
  MPI_Comm comm = MPI_COMM_NULL;  ///< the ranks of this participant
  int rank = 0;
  std::string name;    ///< of this participant
  bool alone = false;  ///< standalone run
  std::vector<JobMember> members;
  const config::Document* document = nullptr;
  SimulationParameters simulation;
  std::filesystem::path case_folder;               ///< folder of the YAML
  std::filesystem::path output_folder;             ///< <output>/<name>, exists
  std::filesystem::path checkpoints;               ///< <output>/checkpoints
  std::filesystem::path restart_folder;            ///< checkpoint to continue from; empty for a fresh start
  double restart_time;                             ///< its time [s]; NaN for a fresh start
  std::vector<diagnostics::EffectChoice> choices;  ///< of `effects: auto`
  Supervisor* supervisor = nullptr;
  FaultInjection* faults = nullptr;

  /// Tells the other processes the current phase of this one.
  void enter(Phase phase) const {
    supervisor->enter(phase);
    faults->at(couplet::app::name(phase));
  }
  const JobMember* find(const std::string& participant) const;
  /// True if all structures of the job obey linear theory, so that loads act on their undeformed surfaces.
  bool has_linear_structures() const;
  /// Intercommunicator between this participant and another. Both must call it in a deadlock-free order: the
  /// coupler first, by order of members. Collective over both.
  MPI_Comm connect(const std::string& participant) const;
};

/// Entry point of any program of a job. Answers questions (--check, --docs, ...) at once. Otherwise starts
/// MPI, performs the roll call and calls `run`. Reports an exception once and then ends the whole job. Exit
/// codes: 0 success; 1 the run failed; 2 invalid configuration or launch; 3 stopped by a signal, saved; 4
/// completed, but a finding of severity `wrong` was not accepted.
int run_job(int argc, char** argv, const Program& program, const std::function<int(const Job&)>& run);

}  // namespace couplet::app
