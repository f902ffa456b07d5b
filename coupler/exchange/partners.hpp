// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/coupling/channel.hpp"
#include "common/diagnostics/error_parts.hpp"

namespace couplet::coupler {

/// A participant as the coupler talks to it.
struct Partner {
  std::unique_ptr<coupling::Channel> channel;
  int sub_steps = 1;   ///< within a coupling step
  double seconds = 0;  ///< it has spent in the step under way
  double seconds_since_accepted = 0;
  coupling::StepReport report;  ///< of the last accepted step
  double advised_dt = 0;
  coupling::Surfaces surfaces;  ///< of its vertices
  std::string introduction;     ///< what its program was configured by; empty: it says nothing
  coupling::Exchange
      initial;  ///< values before the first step that it gave at its start; none: it gave no values

  const std::string& name() const { return channel->name(); }
  void send(coupling::Command&& command) { send(command); }
  void send(coupling::Command& command) {
    command.step.sub_steps = sub_steps;
    channel->send(command);
  }
  /// Throws SolveFailure (SchemeFailure if a smaller step would not help) naming the participant if the reply
  /// is a failure.
  coupling::Reply receive();
};

/// The command to everyone at once, then all replies; failures are collected and thrown together as one
/// SolveFailure.
void ask_all(const std::vector<Partner*>& partners, const coupling::Command& command);
/// The interface of each, in their order; their initial values go to the partners.
std::vector<coupling::Interface> initialise_all(const std::vector<Partner*>& partners);
/// Last words, one after the other, so that they do not mix; what each knows of its error. `problem`: why the run stopped before its
/// end; empty: it did not. `last`: for each what the others gave last, which no further step would bring.
std::vector<diagnostics::NamedErrors> finalise_all(const std::vector<Partner*>& partners,
                                                   const std::string& problem,
                                                   std::vector<coupling::Exchange> last);
/// The smallest step that somebody advises [s].
double advised_dt(const std::vector<Partner*>& partners);

}  // namespace couplet::coupler
