// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace couplet {

/// What a table's file is read with. Throws Error where it cannot be read or is no file: a pipe would wait for ever
/// for somebody to write.
std::ifstream open_table(const std::filesystem::path& file);

/// The cells of a line, without blanks around them: parted by commas or semicolons, else by blanks where
/// `blanks_part` says so; '#' begins a comment. Empty for a line without cells.
std::vector<std::string> cells_of(std::string line, bool blanks_part);

/// Empty unless the whole text is one finite number.
std::optional<double> number_of(std::string_view text);

/// "time [ms]": its name and its unit, which is empty without brackets.
struct Heading {
  std::string name, unit;
};
Heading heading_of(std::string_view cell);

}  // namespace couplet
