// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <memory>
#include <string>

#include "common/coupling/messages.hpp"

namespace couplet::coupling {

/// Connection from the coupler to one participant. Each command has one reply. Commands can be sent to
/// several participants before the first reply is received, so they work concurrently. Collective over the
/// coupler's ranks: data and positions are each rank's own part, everything else is the same on all ranks.
class Channel {
 public:
  virtual ~Channel() = default;
  virtual const std::string& name() const = 0;
  virtual void send(const Command& command) = 0;
  virtual Reply receive() = 0;
  /// Offers the arrays of an earlier reply for the next one, to save allocations.
  virtual void reuse(Exchange) {}
  /// Processor time [s] that this process has spent waiting for replies or inside the participant.
  virtual double waiting_seconds() const { return 0; }
};

/// Channel to another program. Heads go between the ranks 0 of the intercommunicator, values from rank to
/// rank. The participant's vertices and faces are distributed evenly over the coupler's ranks.
class MpiChannel final : public Channel {
 public:
  /// `comm` contains the coupler's ranks.
  MpiChannel(std::string name, MPI_Comm peers, MPI_Comm comm)
      : name_(std::move(name)), peers_(peers), comm_(comm) {}
  const std::string& name() const override { return name_; }
  void send(const Command& command) override;
  Reply receive() override;
  void reuse(Exchange old) override {
    if (!old.empty()) spare_ = std::move(old);
  }
  double waiting_seconds() const override { return waiting_seconds_; }

 private:
  Reply unpacked(const std::vector<char>& head, Partition& cut) const;
  void receive_places(Interface& interface, Surfaces& surfaces);
  void receive_values(Exchange& data);

  std::string name_;
  MPI_Comm peers_, comm_;
  Op pending_ = Op::initialise;
  int dim_ = 0;
  std::vector<Interface::Datum> takes_, gives_;
  Exchange spare_;
  double waiting_seconds_ = 0;
  Partition theirs_, mine_;  // the same entities, distributed over the participant's and the coupler's ranks
};

/// Entities, both vertices and faces, that this rank exchanges with a rank of the other side.
struct Exchanged {
  int rank;
  Slice slice;
};
std::vector<Exchanged> exchanged(const Partition& mine, int rank, const Partition& theirs);

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
