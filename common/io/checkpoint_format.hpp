// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace couplet::io {

constexpr const char* checkpoint_format = "couplet checkpoint";
// Version 3 added the errors of steps, the net heat of a tank's report and the source of the pressure
// preconditioner. 4: order of the errors. 5: fields by the numbers of cells, points and faces. 6: the scheme
// that a coupling chose. 7: the memory of diagnostics.
constexpr int checkpoint_version = 8;

// arrays/NAME with layout/NAME: values rank by rank; count and checksum of each rank.
// fields/NAME with checks/NAME: rows by the entries' numbers; rows, values per row, checksum over all ranks.
// copies/NAME (an array): position and value of a rank's entries that differ from their owner's.
inline std::string array_path(const std::string& name) { return "arrays/" + name; }
inline std::string layout_path(const std::string& name) { return "layout/" + name; }
inline std::string field_path(const std::string& name) { return "fields/" + name; }
inline std::string check_path(const std::string& name) { return "checks/" + name; }
inline std::string scalar_path(const std::string& name) { return "scalars/" + name; }
inline std::string copies_of(const std::string& name) { return "copies/" + name; }
constexpr const char* mesh_table = "mesh";
constexpr const char* shares_table = "shares";  // mesh::share_of_rank() of each rank

inline std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

/// FNV-1a hash of the bit patterns. It is cheap and detects any flipped bit of an array.
inline std::int64_t checksum(std::span<const double> values) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const double value : values) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 1099511628211ull;
    hash ^= hash >> 29;
  }
  return std::bit_cast<std::int64_t>(hash);
}

/// Checksum of the part of an array from `first` on. The sum over all parts is independent of the partition.
inline std::uint64_t part_of_checksum(std::span<const double> values, std::uint64_t first) {
  std::uint64_t sum = 0;
  for (const double value : values) {
    std::uint64_t hash = std::bit_cast<std::uint64_t>(value) ^ (++first * 0x9e3779b97f4a7c15ull);
    hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
    hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
    sum += hash ^ (hash >> 31);
  }
  return sum;
}

}  // namespace couplet::io
