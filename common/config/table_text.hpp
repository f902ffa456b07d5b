// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>

#include "common/config/visitor.hpp"

namespace couplet::config {

/// A table given as a mapping becomes the text of an expression, in SI:
///   {of: t, at: [0, 2 s], values: [0, 3 bar], outside: error}   table(t, error, 0, 0, 2, 300000)
///   {of: z, file: profile.csv, column: speed}                   table(z, clamp, "/case/profile.csv", "speed")
/// Throws Error with a sentence without place.
std::string table_text(const YAML::Node& node, const Key::Facts& facts, const std::filesystem::path& folder);

/// Relative file names of the tables in an expression, table(t, "a.csv"), made absolute.
std::string with_absolute_files(const std::string& text, const std::filesystem::path& folder);

}  // namespace couplet::config
