// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <string>

#include "common/coupling/messages.hpp"

namespace couplet::coupling {

/// Executes one command on a participant; only here do messages become calls. A SolveFailure becomes a
/// failure reply, other exceptions propagate. Collective over `comm`; rank 0 fills data and interface.
Reply carry_out(const Command& command, Participant& participant, const std::string& name, MPI_Comm comm);

/// Callbacks on every rank of the participant, for the watch over the job and its timers.
struct ServeObserver {
  std::function<void()> waiting = [] {};                                 ///< before each wait for a command
  std::function<void(const Command&)> received = [](const Command&) {};  ///< before it is executed
  std::function<void(const Command&)> done = [](const Command&) {};      ///< after that, before the reply
  /// Adds parts of the run's error (ErrorParts::text()) to the reply to `finalise`, or nothing.
  std::function<std::string()> last_word = [] { return std::string(); };
  /// Called after each accepted step, with a report whose seconds are not filled in.
  std::function<void(const Command&, const StepReport&)> accepted = [](const Command&, const StepReport&) {};
};

/// Participant's side of a coupled run. Receives commands on rank 0, broadcasts and executes them and
/// replies, until it has replied to `finalise`. `coupler` is the intercommunicator to the coupler's rank 0.
void serve(MPI_Comm coupler, MPI_Comm comm, const std::string& name, Participant& participant,
           const ServeObserver& observer);

}  // namespace couplet::coupling
