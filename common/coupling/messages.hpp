// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/types.hpp"
#include "common/coupling/participant.hpp"

namespace couplet::coupling {

/// Partition of a list into contiguous blocks: rank r has entries starts[r] to starts[r + 1].
using Starts = std::vector<GlobalIndex>;

inline Starts starts_of(const std::vector<GlobalIndex>& counts) {
  Starts starts{0};
  for (const GlobalIndex n : counts) starts.push_back(starts.back() + n);
  return starts;
}

/// Distributes n entries evenly: rank r has [n r / ranks, n (r + 1) / ranks).
inline Starts even_starts(GlobalIndex n, int ranks) {
  Starts starts;
  for (int r = 0; r <= ranks; ++r) starts.push_back(n * r / ranks);
  return starts;
}

inline int owner_of(const Starts& starts, GlobalIndex position) {
  return int(std::upper_bound(starts.begin(), starts.end(), position) - starts.begin()) - 1;
}

/// Intersection of this rank's block with another rank's block in a different partition of the same list.
struct Overlap {
  int rank;                  ///< rank of the other partition
  std::size_t first, count;  ///< within this rank's block
};

inline std::vector<Overlap> overlaps(const Starts& mine, int rank, const Starts& theirs) {
  std::vector<Overlap> result;
  const GlobalIndex low = mine[std::size_t(rank)], high = mine[std::size_t(rank) + 1];
  for (std::size_t r = 0; r + 1 < theirs.size(); ++r) {
    const GlobalIndex first = std::max(low, theirs[r]), end = std::min(high, theirs[r + 1]);
    if (first < end) result.push_back({int(r), std::size_t(first - low), std::size_t(end - first)});
  }
  return result;
}

/// Operations that a coupler can request. The numbers are part of the protocol (docs/protocol.md).
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

/// Message from coupler to participant.
struct Command {
  Op op = Op::initialise;
  Step step;           ///< begin_step
  Exchange data;       ///< solve, start, finalise: the input, this rank's entries
  double time = 0;     ///< accept_step, write_output: the accepted time t^{n+1} [s]
  int output = -1;     ///< accept_step, write_output: number of the output that is due, or -1
  std::string folder;  ///< save, load: of the checkpoint, with <name>.h5; finalise: why the run failed
};

/// Vertices on separate surfaces (a guest's meshes), and the data that exist only there.
struct Surfaces {
  std::vector<int> of_vertex{};  ///< per vertex of this rank; empty if there are none
  /// Surface of a datum at vertices. Data not listed are at all vertices.
  std::map<std::string, int> takes{}, gives{};
  /// Received data that also need values within the step (see WithinStep).
  std::set<std::string> within{};
};

/// Message from participant to coupler. Every command has exactly one reply.
struct Reply {
  enum class Status : std::int64_t {
    ok = 0,
    failure = 1,   ///< the step could not be solved (`text` states why); state n is unchanged
    hopeless = 2,  ///< as `failure`, and a smaller step would not help
    left = 3,      ///< the program has left the coupling before its end
  };
  Status status = Status::ok;
  std::string text;
  double seconds = 0;                                             ///< spent on the command
  double suggested_dt = std::numeric_limits<double>::infinity();  ///< initialise, accept_step, load
  StepReport report;                                              ///< accept_step
  Exchange data;         ///< solve: the output; initialise: values before the first step; this rank's entries
  bool renewed = false;  ///< solve: Participant::renewed_prediction()
  Interface interface;   ///< initialise: this rank's entries
  Surfaces surfaces;     ///< initialise
};

/// Distribution of a participant's surface over its ranks, part of the reply to initialise.
struct Partition {
  Starts vertices{0}, faces{0};
};

/// Packs the head of a message: everything but the values at vertices and faces, which it only names. Sent
/// between the ranks 0.
std::vector<char> pack(const Command& command);
std::vector<char> pack(const Reply& reply, const Partition& cut);
/// Unpacks a head. Throws Error if the bytes are not such a message of this protocol version. The data get
/// their names, but no values.
Command unpack_command(std::span<const char> bytes);
Reply unpack_reply(std::span<const char> bytes, Partition& cut);

/// Part of a rank's values that goes to another rank. All data of `names` follow one another, each at the
/// vertices or faces of the slice. Data without values are omitted. Throws Error if an array does not have
/// the announced length.
struct Slice {
  std::size_t first_vertex = 0, vertices = 0, first_face = 0, faces = 0;  ///< within this rank's entries
  bool empty() const { return vertices == 0 && faces == 0; }
};
std::vector<std::span<const double>> cut_out(const Exchange& data, const std::vector<Interface::Datum>& of,
                                             int dim, const Slice& slice, const std::string& whose);
/// Returns the same slices of arrays that are to be filled.
std::vector<std::span<double>> places_in(Exchange& data, const std::vector<Interface::Datum>& of, int dim,
                                         const Slice& slice, const std::string& whose);
/// Data of `announced` that are in `data`, by name; values within the step have their own names. Throws Error
/// if a name was not announced.
std::vector<Interface::Datum> present(const Exchange& data, const std::vector<Interface::Datum>& announced,
                                      const std::string& whose);

/// Packs the vertices and faces of a slice, once.
std::vector<char> cut_out(const Interface& interface, const Slice& slice);
void put_back(std::span<const char> bytes, Interface& interface, std::vector<int>& surface_of_vertex);

inline constexpr std::int64_t protocol_version = 8;
inline constexpr int command_tag = 101, reply_tag = 102, input_tag = 103, places_tag = 104, output_tag = 105;

inline constexpr std::int64_t largest_integer = std::numeric_limits<std::int64_t>::max();
inline constexpr std::int64_t most_sub_steps = 1000000, most_surfaces = 1000;

/// Reader of messages between programs. A guest may send anything, so every length is checked against the
/// available bytes before memory is allocated, and every number against its range. Throws Error. Only
/// messages.cpp uses it.
class Unpacker {
 public:
  static constexpr std::size_t longest_name = 256;

  Unpacker(std::span<const char> bytes, const char* what) : bytes_(bytes), what_(what) {}
  Unpacker(std::span<const char> bytes, std::int64_t mark, const char* what) : Unpacker(bytes, what) {
    if (integer() != mark) throw Error("Received a message that is not the expected {}.", what_);
    const std::int64_t version = integer();
    if (version != protocol_version)
      throw Error(
          "A {} has protocol version {}, but this program uses version {}: use programs of one version.",
          what_, version, protocol_version);
  }
  std::int64_t integer() { return plain<std::int64_t>(); }
  std::int64_t integer(std::int64_t least, std::int64_t most, const char* field) {
    const std::int64_t value = integer();
    if (value < least || value > most)
      throw Error("A {} gives {} as {}; expected {} to {}.", what_, field, value, least, most);
    return value;
  }
  double real() { return plain<double>(); }
  std::string text() {
    std::string value(length(1), '\0');
    raw(value.data(), value.size());
    return value;
  }
  /// Reads a name that is valid in messages and files.
  std::string name() {
    std::string value = text();
    bool sound = value.size() <= longest_name;
    for (const char c : value) sound = sound && static_cast<unsigned char>(c) >= 32 && c != 127;
    if (!sound)
      throw Error(
          "A {} contains an invalid name ({} bytes, or with control characters); at most {} bytes are "
          "allowed.",
          what_, value.size(), longest_name);
    return value;
  }
  Vec3 point(const char* of) {
    Vec3 p;
    raw(p.data(), 3 * sizeof(double));
    if (!p.allFinite()) throw Error("A {} gives {} as ({}, {}, {}).", what_, of, p[0], p[1], p[2]);
    return p;
  }
  /// Reads the length of a list whose entries take at least `words` times 8 bytes.
  std::size_t count(std::size_t words) { return length(8 * words); }
  /// Reads offsets of a partition, which must start at 0 and not decrease.
  std::vector<GlobalIndex> cut(const char* of) {
    std::vector<GlobalIndex> values(length(sizeof(GlobalIndex)));
    raw(values.data(), values.size() * sizeof(GlobalIndex));
    bool sound = !values.empty() && values.front() == 0 && values.back() <= std::numeric_limits<Index>::max();
    for (std::size_t i = 1; i < values.size(); ++i) sound = sound && values[i] >= values[i - 1];
    if (!sound)
      throw Error(
          "A {} partitions its {} over ranks incorrectly: the offsets must start at 0 and never decrease.",
          what_, of);
    return values;
  }
  std::vector<std::string> names() {
    std::vector<std::string> list;
    for (std::size_t n = count(1); n > 0; --n) list.push_back(name());
    return list;
  }
  Exchange exchange() {
    Exchange data;
    for (std::size_t n = count(1); n > 0; --n) data[name()];
    return data;
  }
  /// `surfaces` receives data that exist only at the vertices of one surface (location 2 + surface).
  std::vector<Interface::Datum> data(std::map<std::string, int>& surfaces) {
    std::vector<Interface::Datum> list;
    for (std::size_t n = count(4); n > 0; --n) {
      Interface::Datum datum{name(), "", Interface::Place::vertices};
      datum.unit = name();
      const std::int64_t place = integer(0, 2 + most_surfaces, "the location of a datum");
      datum.place = place == 1 ? Interface::Place::faces : Interface::Place::vertices;
      if (place >= 2) surfaces[datum.name] = int(place - 2);
      datum.components = static_cast<int>(integer(0, 9, "the number of components of a datum"));
      list.push_back(datum);
    }
    return list;
  }
  void finish() const {
    if (position_ != bytes_.size()) throw Error("A {} is longer than its content.", what_);
  }

 private:
  template <class T>
  T plain() {
    T value;
    raw(&value, sizeof value);
    return value;
  }
  std::size_t length(std::size_t size_of_entry) {
    const std::int64_t n = integer();
    if (n < 0 || std::size_t(n) > (bytes_.size() - position_) / size_of_entry) truncated();
    return std::size_t(n);
  }
  void raw(void* to, std::size_t size) {
    if (size > bytes_.size() - position_) truncated();
    if (size > 0) std::memcpy(to, bytes_.data() + position_, size);
    position_ += size;
  }
  [[noreturn]] void truncated() const { throw Error("A {} is truncated.", what_); }

  std::span<const char> bytes_;
  const char* what_;
  std::size_t position_ = 0;
};

}  // namespace couplet::coupling
