// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <string>

#include "common/coupling/messages.hpp"

namespace couplet::coupling {

/// One command carried out on a participant: the one place where messages become calls. A SolveFailure
/// becomes a failure reply; anything else passes through. Collective over `comm`; data and interface are
/// filled on rank 0.
Reply carry_out(const Command& command, Participant& participant, const std::string& name, MPI_Comm comm);

/// Called on every rank of the participant; used for the watch over the job and for its timers.
struct ServeObserver {
  std::function<void()> waiting = [] {};                                 ///< before each wait for a command
  std::function<void(const Command&)> received = [](const Command&) {};  ///< before it is carried out
  std::function<void(const Command&)> done = [](const Command&) {};      ///< after that, before the reply
  /// For the reply to `finalise`: parts of the run's error (ErrorParts::text()), or nothing.
  std::function<std::string()> last_word = [] { return std::string(); };
  /// After each accepted step; its seconds are not filled in.
  std::function<void(const Command&, const StepReport&)> accepted = [](const Command&, const StepReport&) {};
};

/// The participant's side of a coupled run: receives commands on rank 0, hands them to all ranks, carries
/// them out and replies, until `finalise` was replied to. `coupler`: intercommunicator to the coupler's rank
/// 0.
void serve(MPI_Comm coupler, MPI_Comm comm, const std::string& name, Participant& participant,
           const ServeObserver& observer);

}  // namespace couplet::coupling
