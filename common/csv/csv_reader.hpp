// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/csv/line_reader.hpp"

namespace couplet::csv {

/// Between cells: ',', ';', a tab, or ' ' for any number of blanks and tabs.
using Separator = char;

/// The separator of a line: the first of ';', ',' and tab that it holds outside quotes, else blanks.
Separator separator_of(std::string_view line);

/// The cells of a line, without blanks and double quotes around them; they point into `line`. What stands within double
/// quotes does not separate. False: a quote is not closed.
bool split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells);
/// As texts, where foreign files have quotes that close nothing.
std::vector<std::string> fields(std::string_view line, Separator separator = ',');

/// The line before the '#' of a comment.
std::string_view without_comment(std::string_view line);

/// Empty unless the whole text is one finite number as 1, -0.5 or 2e3.
std::optional<double> number_of(std::string_view text);
/// Whole numbers likewise.
std::optional<int> integer_of(std::string_view text);

/// Why a text that should be a number is none: "'0,5' has a decimal comma; write 0.5".
std::string why_no_number(std::string_view text);

/// "time [ms]": its name and its unit, which is empty without brackets.
struct Heading {
  std::string name, unit;
};
Heading heading_of(std::string_view cell);

/// Row by row through a table: cells separated by one of comma, semicolon, tab or blanks, the same in the whole file and as many
/// in each row; '#' begins a comment; the first line may name the columns. Throws Error with file and line, and with what to
/// do, for ragged rows, decimal commas, separators that could be meant otherwise, and cells that are no finite numbers.
class CsvReader final {
 public:
  /// Reads up to the names or the first row.
  CsvReader(const std::filesystem::path& file, const std::string& kind, const Limits& limits = {});

  /// Cells of the first line; empty where it holds numbers.
  const std::vector<std::string>& names() const { return names_; }
  std::string place_of_names() const;

  /// The next row. False at the end.
  bool next();
  const std::vector<std::string_view>& cells() const { return cells_; }
  /// The number in a cell of the row. `what` names it in messages: "the wind".
  double number(std::size_t column, std::string_view what = "") const;
  std::string place() const { return lines_.place(); }
  int line() const { return int(lines_.number()); }

 private:
  bool next_line();
  void take_names();
  void check_width() const;
  void refuse_ambiguous() const;

  LineReader lines_;
  std::vector<std::string> names_;
  std::vector<std::string_view> cells_;
  Separator separator_ = ',';
  std::size_t width_ = 0;
  int line_of_names_ = 0, first_line_ = 0;
  bool row_waits_ = false, has_points_ = false;
};

}  // namespace couplet::csv
