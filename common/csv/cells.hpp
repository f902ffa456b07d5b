// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace couplet::csv
