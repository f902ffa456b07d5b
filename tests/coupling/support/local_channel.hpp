// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/coupling/channel.hpp"
#include "common/coupling/step_plan.hpp"
#include "coupler/coupler.hpp"

namespace couplet::coupling {

/// Channel to a participant inside this process, by function calls.
class LocalChannel final : public Channel {
 public:
  /// The participant must outlive the channel.
  LocalChannel(std::string name, Participant& participant, MPI_Comm comm = MPI_COMM_SELF)
      : name_(std::move(name)), participant_(participant), comm_(comm) {}
  const std::string& name() const override { return name_; }
  void send(const Command& command) override {
    if (command.op == Op::initialise) participant_.set(command.step.sub_steps);
    reply_ = carry_out(command, participant_, name_, comm_);
  }
  Reply receive() override { return std::move(reply_); }

 private:
  std::string name_;
  SubStepping participant_;
  MPI_Comm comm_;
  Reply reply_;
};

}  // namespace couplet::coupling

namespace couplet::tests {

/// Coupler of participants in one process, called "fluid", "solid" and "mover".
class LocalCoupler final : public coupler::Coupler {
 public:
  LocalCoupler(coupler::CouplingParameters coupling, const app::SimulationParameters& simulation,
               coupling::Participant& fluid, coupling::Participant& solid, coupling::Participant* mover,
               coupler::CouplerFolders folders)
      : Coupler(MPI_COMM_SELF, with_roles(std::move(coupling), mover != nullptr), simulation,
                channels(fluid, solid, mover), std::move(folders)) {}

 private:
  static coupler::CouplingParameters with_roles(coupler::CouplingParameters p, bool has_mover) {
    if (!p.fluid) p.fluid.emplace();
    p.fluid->participant = "fluid";
    if (!p.structure) p.structure.emplace();
    p.structure->participant = "solid";
    if (has_mover) p.mesh = {"mover"};
    return p;
  }
  static std::vector<std::unique_ptr<coupling::Channel>> channels(coupling::Participant& fluid,
                                                                  coupling::Participant& solid,
                                                                  coupling::Participant* mover) {
    std::vector<std::unique_ptr<coupling::Channel>> list;
    list.push_back(std::make_unique<coupling::LocalChannel>("fluid", fluid));
    list.push_back(std::make_unique<coupling::LocalChannel>("solid", solid));
    if (mover) list.push_back(std::make_unique<coupling::LocalChannel>("mover", *mover));
    return list;
  }
};

}  // namespace couplet::tests
