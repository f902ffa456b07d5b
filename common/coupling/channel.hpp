// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <memory>
#include <string>

#include "common/coupling/messages.hpp"

namespace couplet::coupling {

/// How the coupler talks to one participant. A command is sent, then its reply received; several participants
/// may be sent to before the first reply is received, so they work at the same time. Collective over the
/// coupler's ranks: data and places are each rank's own part, all else is the same on all.
class Channel {
 public:
  virtual ~Channel() = default;
  virtual const std::string& name() const = 0;
  virtual void send(const Command& command) = 0;
  virtual Reply receive() = 0;
  /// Arrays of an earlier reply, for the values of the next: what has its size need not be made and zeroed anew.
  virtual void reuse(Exchange) {}
  /// Of the participant.
  virtual int ranks() const { return 1; }
  /// Processor seconds that this process has spent waiting for replies so far, or has lent to the participant.
  virtual double waiting_seconds() const { return 0; }
};

/// To another program: heads from rank 0 to rank 0 of the intercommunicator, values from rank to rank. The
/// participant's vertices and faces are cut anew, evenly, over the coupler's ranks.
class MpiChannel final : public Channel {
 public:
  /// `comm`: the coupler's ranks.
  MpiChannel(std::string name, MPI_Comm peers, MPI_Comm comm)
      : name_(std::move(name)), peers_(peers), comm_(comm) {}
  const std::string& name() const override { return name_; }
  void send(const Command& command) override;
  Reply receive() override;
  void reuse(Exchange old) override {
    if (!old.empty()) spare_ = std::move(old);
  }
  int ranks() const override;
  double waiting_seconds() const override { return waiting_seconds_; }

 private:
  Reply unpacked(const std::vector<char>& head, Cut& cut) const;
  void receive_places(Interface& interface, Surfaces& surfaces);
  void receive_values(Exchange& data);

  std::string name_;
  MPI_Comm peers_, comm_;
  Op pending_ = Op::initialise;
  int dim_ = 0;
  std::vector<Interface::Datum> takes_, gives_;
  Exchange spare_;
  double waiting_seconds_ = 0;
  Cut theirs_, mine_;  // the same list of places, cut over the participant's and the coupler's ranks
};

/// To a participant inside this process: a function call.
class LocalChannel final : public Channel {
 public:
  /// The participant must outlive the channel.
  LocalChannel(std::string name, Participant& participant, MPI_Comm comm = MPI_COMM_SELF);
  ~LocalChannel() override;
  const std::string& name() const override { return name_; }
  void send(const Command& command) override;
  Reply receive() override { return std::move(reply_); }
  double waiting_seconds() const override { return waiting_seconds_; }

 private:
  std::string name_;
  std::unique_ptr<class SubStepping> participant_;
  MPI_Comm comm_;
  Reply reply_;
  double waiting_seconds_ = 0;
};

/// Which rank of the other side takes or gives which of my places, both kinds at once.
struct Exchanged {
  int rank;
  Slice slice;
};
std::vector<Exchanged> exchanged(const Cut& mine, int rank, const Cut& theirs);

}  // namespace couplet::coupling
