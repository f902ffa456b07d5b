// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/coupling/channel.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// The channel to a fluid that calls its data otherwise: a program on preCICE's interface. The displacement [m] goes to
/// it by its name, its force [N] goes on as the pressure's; the force of viscosity is part of it and is given as zero.
class ForeignFluid final : public coupling::Channel {
 public:
  ForeignFluid(std::unique_ptr<coupling::Channel> channel, CouplingParameters::Fluid names)
      : channel_(std::move(channel)), names_(std::move(names)) {}

  /// Brings the announced surface into the coupler's words. Throws Error where a name is not announced, or not a vector in
  /// metres (or without a unit) at vertices or in newtons.
  void adapt(coupling::Interface& own, coupling::Surfaces& surfaces);

  const std::string& name() const override { return channel_->name(); }
  void send(const coupling::Command& command) override;
  coupling::Reply receive() override;
  int ranks() const override { return channel_->ranks(); }
  double waiting_seconds() const override { return channel_->waiting_seconds(); }

 private:
  std::unique_ptr<coupling::Channel> channel_;
  CouplingParameters::Fluid names_;
};

}  // namespace couplet::coupler
