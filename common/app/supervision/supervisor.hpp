// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <string>
#include <string_view>
#include <thread>

namespace couplet::app {

/// Activity of a process, which the others report if it dies.
enum class Phase : int {
  roll_call,
  initialise,
  waiting,
  begin_step,
  solve,
  accept,
  output,
  save,
  load,
  finalise,
};
const char* name(Phase phase);

/// Mutual watch of a job's processes on one machine. Each writes its identity and phase to a page of shared
/// memory. MPI's launcher ends a job with SIGTERM when a process dies. The first survivor to handle the
/// signal then prints one line with the dead processes and their last phase. If none is dead, SIGTERM is a
/// stop request: the step loop saves the state and ends the run. A job whose processes all wait for each
/// other is ended, too. One Supervisor per process stays in force until it ends.
class Supervisor {
 public:
  /// Must be called right after MPI_Init. Collective over `world`.
  Supervisor(MPI_Comm world, const std::string& participant);
  Supervisor(const Supervisor&) = delete;
  /// Installs the signal handlers, again after libraries that replace them, such as PETSc.
  static void install();
  /// Sets the rank within the participant, once it is known.
  void set_rank(int rank);
  /// An external program's process ("PID@MACHINE"), which is named if it dies. Before limit_silence().
  void add_guest(const std::string& participant, const std::string& process);
  void enter(Phase phase);
  Phase phase() const { return phase_; }
  void set_time(double time);
  /// Returns true for the first process of this participant on this machine that asks. It prints the error.
  bool claim_report();
  /// Starts a thread that watches the processes of this machine. It ends the job and names a process without
  /// sign of life for this time [s] (see log/life.hpp), unless that only waits for others. 0 disables it.
  void limit_silence(double seconds);

  /// Returns true after a signal asked this job to stop during its steps.
  static bool stop_requested();
  /// Records that the job saved its state and stops as requested.
  static void stopped();
  static bool has_stopped();
  /// Announces that this process ends the job on purpose, so that the others need not look for a cause.
  void ending();
  /// Announces that this process has finished with MPI and may disappear.
  static void finished();

 private:
  Phase phase_ = Phase::roll_call;
  std::jthread guard_;
};

/// Fault injection for tests: COUPLET_FAULT="solid:solve:2" kills rank 0 of participant 'solid' with SIGKILL
/// at its second solve; "solid:solve:2:1" kills rank 1. A fifth part selects another fault: hang (without a
/// sign of life), work (7 s, with signs of life), wait (for a message that is never sent), stop (SIGSTOP).
/// Phases are those of app/supervision/supervisor.hpp. Without the variable nothing happens.
class FaultInjection {
 public:
  FaultInjection(std::string_view participant, int rank);
  void at(std::string_view phase);

 private:
  bool armed_ = false;
  std::string phase_, fate_;
  int remaining_ = 0;
};

/// Ends the job if its start exceeds the hang timeout. A Supervisor cannot do so, because processes wait in
/// MPI_Init before they know each other. Create it before MPI_Init; the destructor disarms it.
class StartDeadline {
 public:
  /// `seconds` is 0 for never. `label` starts the message.
  StartDeadline(double seconds, std::string label);

 private:
  std::jthread guard_;
};

}  // namespace couplet::app
