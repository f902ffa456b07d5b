// SPDX-License-Identifier: Apache-2.0
#include "common/fv/csv_line.hpp"

#include <cmath>
#include <stdexcept>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet {

std::ifstream open_table(const std::filesystem::path& file) {
  std::error_code ignored;
  std::ifstream stream;
  const bool is_file = std::filesystem::is_regular_file(file, ignored);
  if (is_file) stream.open(file);
  if (!is_file || !stream) throw Error("{}: this file of a table cannot be read.", file.string());
  return stream;
}

std::vector<std::string> cells_of(std::string line, bool blanks_part) {
  line = line.substr(0, line.find('#'));
  blanks_part = blanks_part && line.find_first_of(",;") == std::string::npos;
  for (char& c : line)
    if (c == ';' || (blanks_part && (c == ' ' || c == '\t'))) c = ',';
  std::vector<std::string> cells;
  for (const std::string& cell : split(line, ',')) {
    const std::string text(trim(cell));
    if (!blanks_part || !text.empty()) cells.push_back(text);
  }
  if (cells.size() == 1 && cells[0].empty()) cells.clear();
  return cells;
}

std::optional<double> number_of(std::string_view text) {
  const std::string trimmed(trim(text));
  if (trimmed.empty()) return {};
  std::size_t used = 0;
  try {
    const double value = std::stod(trimmed, &used);
    if (used == trimmed.size() && std::isfinite(value)) return value;
  } catch (const std::exception&) {
  }
  return {};
}

Heading heading_of(std::string_view cell) {
  const std::size_t open = cell.find('[');
  Heading heading{std::string(trim(cell.substr(0, open))), {}};
  if (open != std::string_view::npos) {
    const std::string_view rest = cell.substr(open + 1);
    heading.unit = trim(rest.substr(0, rest.find(']')));
  }
  return heading;
}

}  // namespace couplet
