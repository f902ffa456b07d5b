// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <string>
#include <string_view>
#include <thread>

namespace couplet::app {

/// What a process is doing, for the others to see when it is gone.
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

/// The processes of a job on one machine watch over each other through a small page of shared memory: each
/// writes there who it is and what it does. MPI's launcher ends a job with SIGTERM when one of its processes
/// dies; the handler then finds which processes are gone, and the first survivor to look writes the one line
/// that names them and what they did last. If none is gone, SIGTERM is somebody's wish that the job ends: it is
/// passed on to the loop of steps, which saves the state and ends the run. Where all of them wait for each other the job
/// ends, too. One Watch a process. It stays in force until the process ends.
class Watch {
 public:
  /// Collective over `world`, right after MPI_Init.
  Watch(MPI_Comm world, const std::string& participant);
  Watch(const Watch&) = delete;
  /// Installs the handler (again): to be called after libraries that set handlers of their own, such as
  /// PETSc.
  static void install();
  /// Rank within the participant, once it is known.
  void set_rank(int rank);
  /// An external program's process ("PID@MACHINE"), which is named if it dies. Before limit_silence().
  void add_guest(const std::string& participant, const std::string& process);
  void enter(Phase phase);
  Phase phase() const { return phase_; }
  void set_time(double time);
  /// True for the first process of this participant on this machine that asks: it is the one that prints the
  /// error.
  bool claim_report();
  /// From now on a thread looks whether the processes of this machine go on: one that has shown no sign of life
  /// for so long [s] (see log/life.hpp), and does not just wait for others, ends the job and is named. 0: never.
  void limit_silence(double seconds);

  /// A signal asked this job to stop while it was making steps.
  static bool stop_requested();
  /// The job has saved its state and stops, as asked.
  static void stopped();
  static bool has_stopped();
  /// This process ends the job on purpose: the others need not look for a culprit.
  void ending();
  /// This process is through with MPI: it may be gone from now on.
  static void finished();

 private:
  Phase phase_ = Phase::roll_call;
  std::jthread guard_;
};

/// A test aid: COUPLET_FAULT="solid:solve:2" kills rank 0 of participant 'solid' with SIGKILL when it enters
/// its second solve; "solid:solve:2:1" kills rank 1. A fifth part names another fate: hang (for ever, without a sign of
/// life), work (for 7 s, with signs of life), wait (for a message that nobody sends), stop (SIGSTOP). The phases are those
/// of app/watch.hpp. Without the variable nothing happens.
class FaultInjection {
 public:
  FaultInjection(std::string_view participant, int rank);
  void at(std::string_view phase);

 private:
  bool armed_ = false;
  std::string phase_, fate_;
  int remaining_ = 0;
};

/// Until the processes of a job know each other, a Watch cannot see that one of them hangs: the others wait in
/// MPI_Init for ever. This ends the process, and by that the job, where the start takes longer than the hang timeout.
/// To be made before MPI_Init; disarmed by its end.
class StartGuard {
 public:
  /// `seconds`: 0 for never. `label`: who speaks.
  StartGuard(double seconds, std::string label);

 private:
  std::jthread guard_;
};

}  // namespace couplet::app
