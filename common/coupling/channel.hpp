// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <memory>
#include <string>

#include "common/coupling/messages.hpp"

namespace couplet {

/// How the coupler talks to one participant. A command is sent, then its reply received; several participants
/// may be sent to before the first reply is received, so they work at the same time.
class Channel {
 public:
  virtual ~Channel() = default;
  virtual const std::string& name() const = 0;
  virtual void send(const Command& command) = 0;
  virtual Reply receive() = 0;
};

/// To another program, rank 0 to rank 0 of the intercommunicator.
class MpiChannel final : public Channel {
 public:
  MpiChannel(std::string name, MPI_Comm peers) : name_(std::move(name)), peers_(peers) {}
  const std::string& name() const override { return name_; }
  void send(const Command& command) override;
  Reply receive() override;

 private:
  std::string name_;
  MPI_Comm peers_;
  Op pending_ = Op::initialise;
};

/// To a participant inside this process: a function call.
class LocalChannel final : public Channel {
 public:
  /// The participant must outlive the channel.
  LocalChannel(std::string name, Participant& participant, MPI_Comm comm = MPI_COMM_SELF)
      : name_(std::move(name)), participant_(participant), comm_(comm) {}
  const std::string& name() const override { return name_; }
  void send(const Command& command) override;
  Reply receive() override { return std::move(reply_); }

 private:
  std::string name_;
  Participant& participant_;
  MPI_Comm comm_;
  Reply reply_;
};

}  // namespace couplet
