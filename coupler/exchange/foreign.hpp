// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/coupling/channel.hpp"
#include "common/coupling/messages.hpp"
#include "common/io/checkpoint.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Data of a program with other names than the coupler's, as declared for one role in one direction.
struct ForeignNames {
  std::vector<coupling::Interface::Datum>& data;
  std::map<std::string, int>& surface_of;  ///< for those on one surface only
  const char* role;                        ///< "fluid", "structure"
  const std::string& who;                  ///< the participant
  const char* does;                        ///< "takes", "gives"

  std::vector<coupling::Interface::Datum>::iterator find(const std::string& name) const;
  /// Renames `datum` to `name`.
  void rename(coupling::Interface::Datum& datum, const std::string& name) const;
  /// Assigns `name` to the surface of `datum`.
  void put_beside(const std::string& datum, const std::string& name) const;
  /// Throws Error because the datum named by `key` of the role is missing.
  [[noreturn]] void refuse(const char* key, const std::string& wanted) const;
};

/// Channel to a structure with other data names and without a velocity, such as a program with a preCICE
/// adapter. Its displacement [m] is renamed. Its load is the sum of all forces [N] of the other participants.
/// Its velocity [m/s] is the second-order difference of the displacements at t^{n+1}, t^n and t^{n-1} (first
/// order in the first step, which starts at rest).
class ForeignStructure final : public coupling::Channel {
 public:
  ForeignStructure(std::unique_ptr<coupling::Channel> channel, CouplingParameters::StructureRole names)
      : channel_(std::move(channel)), names_(std::move(names)) {}

  /// Translates the declared surface. `all`: interfaces of all participants, for their forces. Throws Error
  /// for a name that is not declared, or not in meters at vertices or newtons.
  void adapt(coupling::Interface& own, coupling::Surfaces& surfaces,
             const std::vector<coupling::Interface>& all);

  const std::string& name() const override { return channel_->name(); }
  void send(const coupling::Command& command) override;
  coupling::Reply receive() override;
  double waiting_seconds() const override { return channel_->waiting_seconds(); }

  /// Earlier displacements, from which the velocity is computed; empty if the structure gives its velocity.
  void visit(io::Archive& archive);

 private:
  void adapt_displacement(coupling::Interface& own, coupling::Surfaces& surfaces);
  void adapt_load(coupling::Interface& own, coupling::Surfaces& surfaces,
                  const std::vector<coupling::Interface>& all);
  std::vector<double> velocity() const;

  std::unique_ptr<coupling::Channel> channel_;
  CouplingParameters::StructureRole names_;
  bool derives_velocity_ = false;           // the structure gives none
  std::vector<std::string> forces_;         // their sum is the load
  std::vector<double> next_, now_, older_;  // displacements [m]; empty if unknown
  double dt_ = 0, old_dt_ = 0;              // of the current step and the previous one [s]
  std::size_t n_values_ = 0;                // of a displacement on this rank
};

/// Channel to a fluid with other data names, such as a program with a preCICE adapter. The displacement [m]
/// is renamed for it. Its force [N] becomes the pressure force, and the viscous force is zero.
class ForeignFluid final : public coupling::Channel {
 public:
  ForeignFluid(std::unique_ptr<coupling::Channel> channel, CouplingParameters::FluidRole names)
      : channel_(std::move(channel)), names_(std::move(names)) {}

  /// Translates the declared surface. Throws Error for a name that is not declared, or not a vector in meters
  /// (or without unit) at vertices or in newtons.
  void adapt(coupling::Interface& own, coupling::Surfaces& surfaces);

  const std::string& name() const override { return channel_->name(); }
  void send(const coupling::Command& command) override;
  coupling::Reply receive() override;
  double waiting_seconds() const override { return channel_->waiting_seconds(); }

 private:
  std::unique_ptr<coupling::Channel> channel_;
  CouplingParameters::FluidRole names_;
};

}  // namespace couplet::coupler
