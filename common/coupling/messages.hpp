// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"

namespace couplet {

/// What a coupler can ask of a participant. The numbers are part of the protocol (docs/coupling.md).
enum class Op : std::int64_t {
  initialise = 1,
  begin_step = 2,
  solve = 3,
  accept_step = 4,
  write_output = 5,
  save = 6,
  load = 7,
  finalise = 8,
};
const char* name(Op op);

/// Coupler to participant.
struct Command {
  Op op = Op::initialise;
  Step step;           ///< begin_step
  Exchange data;       ///< solve: the input
  double time = 0;     ///< accept_step, write_output: the accepted time t^{n+1} [s]
  int output = -1;     ///< accept_step, write_output: number of the output that is due; -1: none
  std::string folder;  ///< save, load: the checkpoint's folder; the participant's file in it is <name>.h5
};

/// Participant to coupler. Every command has exactly one reply.
struct Reply {
  enum class Status : std::int64_t {
    ok = 0,
    failure = 1,  ///< the step could not be solved (`text` says why); state n is as it was
  };
  Status status = Status::ok;
  std::string text;
  bool shorter_helps = true;  ///< failure: a shorter step may be solved; not sent
  double seconds = 0;         ///< spent on the command
  double suggested_dt = std::numeric_limits<double>::infinity();  ///< initialise, accept_step, load
  Exchange data;                                                  ///< solve: the output
  Interface interface;                                            ///< initialise
  StepReport report;                                              ///< accept_step; its seconds are not sent
};

std::vector<char> pack(const Command& command);
std::vector<char> pack(const Reply& reply);
/// Throw Error if the bytes are not such a message of this version of the protocol.
Command unpack_command(std::span<const char> bytes);
Reply unpack_reply(std::span<const char> bytes);

inline constexpr std::int64_t protocol_version = 3;
inline constexpr int command_tag = 101, reply_tag = 102;

}  // namespace couplet
