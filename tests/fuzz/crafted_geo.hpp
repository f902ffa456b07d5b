// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/fuzz/mutate.hpp"

namespace couplet::fuzz {

/// Statements that run a command, write or read a file elsewhere, or set what would: each leaves, or is meant to leave, a
/// file in the folder `outside`.
std::vector<std::string> payloads(const std::filesystem::path& outside);

/// A payload in one of the ways in which a guard that reads otherwise than gmsh would pass it: behind comments, quotes,
/// branches, macros, files, other characters. Files it needs are written to `folder`.
std::string disguise(const std::string& payload, const std::filesystem::path& folder, Dice& dice);

}  // namespace couplet::fuzz
