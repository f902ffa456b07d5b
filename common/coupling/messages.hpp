// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/blocks.hpp"
#include "common/coupling/participant.hpp"

namespace couplet::coupling {

/// What a coupler can ask of a participant. The numbers are part of the protocol (docs/protocol.md).
enum class Op : std::int64_t {
  initialise = 1,
  begin_step = 2,
  solve = 3,
  accept_step = 4,
  write_output = 5,
  save = 6,
  load = 7,
  finalise = 8,
  start = 9,
};
const char* name(Op op);

/// Coupler to participant.
struct Command {
  Op op = Op::initialise;
  Step step;           ///< begin_step
  Exchange data;       ///< solve, start: the input, this rank's entries
  double time = 0;     ///< accept_step, write_output: the accepted time t^{n+1} [s]
  int output = -1;     ///< accept_step, write_output: number of the output that is due; -1: none
  std::string folder;  ///< save, load: of the checkpoint, with <name>.h5; finalise: why the run failed
};

/// Vertices that belong to surfaces of their own (a guest's meshes), and which data are theirs alone.
struct Surfaces {
  std::vector<int> of_vertex{};  ///< of this rank; empty: there are no such surfaces
  std::map<std::string, int> takes{},
      gives{};  ///< by datum at vertices; one that is not here is at all of them
  std::set<std::string>
      within{};  ///< taken data whose values within the step are wanted, too (see WithinStep)
};

/// Participant to coupler. Every command has exactly one reply.
struct Reply {
  enum class Status : std::int64_t {
    ok = 0,
    failure = 1,   ///< the step could not be solved (`text` says why); state n is as it was
    hopeless = 2,  ///< the same, and a smaller step would not help
  };
  Status status = Status::ok;
  std::string text;
  double seconds = 0;                                             ///< spent on the command
  double suggested_dt = std::numeric_limits<double>::infinity();  ///< initialise, accept_step, load
  StepReport report;                                              ///< accept_step
  Exchange data;        ///< solve: the output, initialise: values before the first step; this rank's entries
  bool anew = false;    ///< solve: Participant::answered_anew()
  Interface interface;  ///< initialise: this rank's entries
  Surfaces surfaces;    ///< initialise
};

/// How a participant's surface is cut over its ranks: part of the reply to initialise.
struct Cut {
  Starts vertices{0}, faces{0};
};

/// Heads of messages: all but the values at vertices and faces, of which they hold the names. From rank 0 to
/// rank 0.
std::vector<char> pack(const Command& command);
std::vector<char> pack(const Reply& reply, const Cut& cut);
/// Throw Error if the bytes are not such a message of this version of the protocol. The data are there by
/// name, empty.
Command unpack_command(std::span<const char> bytes);
Reply unpack_reply(std::span<const char> bytes, Cut& cut);

/// What one rank has of a participant's values, cut further for another rank: all data of `names` one after
/// the other, each the part at vertices or faces; data without a value there are left out. Throws Error if an array has
/// not the announced length.
struct Slice {
  std::size_t first_vertex = 0, vertices = 0, first_face = 0, faces = 0;  ///< within this rank's entries
  bool empty() const { return vertices == 0 && faces == 0; }
};
std::vector<std::span<const double>> cut_out(const Exchange& data, const std::vector<Interface::Datum>& of,
                                             int dim, const Slice& slice, const std::string& whose);
/// The same of arrays that are to be filled.
std::vector<std::span<double>> places_in(Exchange& data, const std::vector<Interface::Datum>& of, int dim,
                                         const Slice& slice, const std::string& whose);
/// Those of `announced` whose names are in `data`, by name, values within the step by their own names; throws Error if a
/// name was not announced.
std::vector<Interface::Datum> present(const Exchange& data, const std::vector<Interface::Datum>& announced,
                                      const std::string& whose);

/// The places themselves, once, the same way.
std::vector<char> cut_out(const Interface& interface, const Slice& slice);
void put_back(std::span<const char> bytes, Interface& interface, std::vector<int>& surface_of_vertex);

inline constexpr std::int64_t protocol_version = 5;
inline constexpr int command_tag = 101, reply_tag = 102, input_tag = 103, places_tag = 104, output_tag = 105;

}  // namespace couplet::coupling
