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
// that a coupling chose. 7: the memory of diagnostics. 9: no checksums beside the digests of the set.
// 10: single values are arrays. 11: the largest speed of a flow. 12: what the filter of the pressure took; until 13.
// 15: pressures of lumped ends.
constexpr int checkpoint_version = 16;

// arrays/NAME with layout/NAME: values rank by rank; count of each rank.
// fields/NAME with checks/NAME: rows by the entries' numbers; rows, values per row.
// copies/NAME (an array): position and value of a rank's entries that differ from their owner's.
inline std::string array_path(const std::string& name) { return "arrays/" + name; }
inline std::string layout_path(const std::string& name) { return "layout/" + name; }
inline std::string field_path(const std::string& name) { return "fields/" + name; }
inline std::string check_path(const std::string& name) { return "checks/" + name; }
inline std::string copies_of(const std::string& name) { return "copies/" + name; }
constexpr const char* mesh_table = "mesh";
constexpr const char* shares_table = "shares";  // mesh::share_of_rank() of each rank

inline std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

}  // namespace couplet::io
