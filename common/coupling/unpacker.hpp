// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/coupling/messages.hpp"

namespace couplet::coupling {

inline constexpr std::int64_t largest_integer = std::numeric_limits<std::int64_t>::max();
inline constexpr std::int64_t most_sub_steps = 1000000, most_surfaces = 1000;

/// The one reader of messages between programs, of which a guest's may hold anything: every length is compared with the
/// bytes that are there before anything is made of it, every number with what it may be. Throws Error. messages.cpp
/// alone uses it.
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
  /// One that stands in messages and files.
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
  /// Of a list whose entries take at least `words` times 8 bytes.
  std::size_t count(std::size_t words) { return length(8 * words); }
  /// How entries are cut over ranks: from 0 on, never downwards.
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
  /// `surfaces`: of data at the vertices of one surface alone (place 2 + surface).
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
