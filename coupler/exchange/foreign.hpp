// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/coupling/channel.hpp"
#include "common/coupling/messages.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::io {
class CheckpointReader;
class CheckpointWriter;
}  // namespace couplet::io

namespace couplet::coupler {

/// Data of a program that calls them otherwise than the coupler, as it announced them: of a role, in one direction.
struct ForeignNames {
  std::vector<coupling::Interface::Datum>& data;
  std::map<std::string, int>& surface_of;  ///< of those of them that are of one surface alone
  const char* role;                        ///< "fluid", "structure"
  const std::string& who;                  ///< the participant
  const char* does;                        ///< "takes", "gives"

  std::vector<coupling::Interface::Datum>::iterator find(const std::string& name) const;
  /// From now on `datum` is called `name`.
  void rename(coupling::Interface::Datum& datum, const std::string& name) const;
  /// `name` is of the same surface as `datum`.
  void put_beside(const std::string& datum, const std::string& name) const;
  /// Throws Error: what `key` of the role names is not among them.
  [[noreturn]] void refuse(const char* key, const std::string& wanted) const;
};

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
