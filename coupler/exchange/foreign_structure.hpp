// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/coupling/channel.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::io {
class CheckpointReader;
class CheckpointWriter;
}  // namespace couplet::io

namespace couplet::coupler {

/// The channel to a structure that calls its data otherwise, and gives no velocity: a program on preCICE's
/// interface. Its displacement [m] goes on by the coupler's name, its load is the sum of all forces [N] of the
/// others, and its velocity [m/s] is the difference of second order through the displacements at t^{n+1}, t^n and
/// t^{n-1} (of first order in the first step; before it the structure is at rest).
class ForeignStructure final : public coupling::Channel {
 public:
  ForeignStructure(std::unique_ptr<coupling::Channel> channel, CouplingParameters::Structure names)
      : channel_(std::move(channel)), names_(std::move(names)) {}

  /// Brings the announced surface into the coupler's words. `all`: of every participant, for the forces that
  /// they give. Throws Error where a name is not announced, or not in metres at vertices or in newtons.
  void adapt(coupling::Interface& own, coupling::Surfaces& surfaces,
             const std::vector<coupling::Interface>& all);

  const std::string& name() const override { return channel_->name(); }
  void send(const coupling::Command& command) override;
  coupling::Reply receive() override;
  int ranks() const override { return channel_->ranks(); }
  double waiting_seconds() const override { return channel_->waiting_seconds(); }

  /// The displacements that its velocity follows from, between steps; nothing where it gives its velocity.
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);

 private:
  void adapt_displacement(coupling::Interface& own, coupling::Surfaces& surfaces);
  void adapt_load(coupling::Interface& own, coupling::Surfaces& surfaces,
                  const std::vector<coupling::Interface>& all);
  std::vector<double> velocity() const;

  std::unique_ptr<coupling::Channel> channel_;
  CouplingParameters::Structure names_;
  bool derives_velocity_ = false;           // none is given
  std::vector<std::string> forces_;         // whose sum is the load
  std::vector<double> next_, now_, older_;  // displacements [m]; empty: not known, as before the start
  double dt_ = 0, old_dt_ = 0;              // of the step under way and the one before [s]
  std::size_t n_values_ = 0;                // of a displacement on this rank
};

}  // namespace couplet::coupler
