// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/coupling/channel.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Participant from the coupler's point of view.
struct Partner {
  std::unique_ptr<coupling::Channel> channel;
  int sub_steps = 1;   ///< within a coupling step
  bool left = false;   ///< before the end of the coupling
  double seconds = 0;  ///< spent in the current step
  double seconds_since_accepted = 0;
  coupling::StepReport report;  ///< of the last accepted step
  double advised_dt = 0;
  coupling::Surfaces surfaces;  ///< surfaces of its vertices
  std::string introduction;     ///< configuration of its program; empty if it declares none
  /// Values that it gave at its start; empty if there are none.
  coupling::Exchange initial;

  const std::string& name() const { return channel->name(); }
  /// A program on preCICE's interface: it has no state to save, and repeats steps only in implicit schemes.
  bool is_precice() const { return introduction.starts_with("xml-"); }
  void send(coupling::Command&& command) { send(command); }
  void send(coupling::Command& command) {
    command.step.sub_steps = sub_steps;
    channel->send(command);
  }
  /// Throws SolveFailure with the participant's name for a failed reply; SchemeFailure if a smaller step does
  /// not help.
  coupling::Reply receive();
};

/// Sends a command to all, then waits for all replies. Collects failures in one SolveFailure.
void command_all(const std::vector<Partner*>& partners, const coupling::Command& command);
/// Returns the interface of each, in order; stores initial values in the partners.
std::vector<coupling::Interface> initialise_all(const std::vector<Partner*>& partners);
/// Ends the participants one after the other, so that their logs do not mix. Returns their estimated errors. `problem`: why
/// the run stopped early; empty if it reached its end. `last`: latest data of the others for each participant.
std::vector<diagnostics::NamedErrors> finalise_all(const std::vector<Partner*>& partners,
                                                   const std::string& problem,
                                                   std::vector<coupling::Exchange> last);
/// Smallest step that a participant recommends [s].
double advised_dt(const std::vector<Partner*>& partners);

/// Checks the configurations of programs with a preCICE adapter, which declare the digest of theirs and their
/// schemes (docs/protocol.md, initialise). Throws Error if they differ from each other or from the
/// configuration of the case (coupling.exchange.digest), or if the scheme or order has changed.
void check_introductions(const CouplingParameters& parameters, const std::vector<Partner>& partners);

/// Why these participants cannot continue from a checkpoint; empty if they can. Throws Error if checkpoints
/// are requested nevertheless (`checkpoint_interval` [s] above 0).
std::string without_state(double checkpoint_interval, const std::vector<Partner>& partners);

/// Checks that `coupling.fluid`, `structure` and `mesh` declare the data of their role (see
/// common/coupling/roles.hpp), and that fluid and structure have the same dimension. Throws Error.
void check_roles(const CouplingParameters& parameters, const std::vector<Side>& sides);

}  // namespace couplet::coupler
