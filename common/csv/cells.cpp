// SPDX-License-Identifier: Apache-2.0
#include "common/csv/cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/text.hpp"

namespace couplet::csv {
namespace {

constexpr std::string_view blanks = " \t";
constexpr std::size_t shown = 60;  // of a cell in messages

/// Without one pair of quotes around it.
std::string_view unquoted(std::string_view cell) {
  cell = base::trim(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
    return base::trim(cell.substr(1, cell.size() - 2));
  return cell;
}

template <class Number>
std::optional<Number> parsed(std::string_view text) {
  text = base::trim(text);
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  Number value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

/// Digits, one or more commas, signs and points: a number as other languages write it.
bool has_decimal_comma(std::string_view text) {
  return text.find(',') != std::string_view::npos &&
         text.find_first_of("0123456789") != std::string_view::npos &&
         text.find_first_not_of("0123456789.,+-eE ") == std::string_view::npos;
}

}  // namespace

Separator separator_of(std::string_view line) {
  for (const char candidate : {';', ',', '\t'}) {
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == candidate && !quoted) return candidate;
    }
  }
  return ' ';
}

bool split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells) {
  cells.clear();
  bool quoted = false;
  std::size_t begin = 0;
  const auto add = [&](std::size_t end) {
    const std::string_view cell = unquoted(line.substr(begin, end - begin));
    if (separator != ' ' || end > begin) cells.push_back(cell);
    begin = end + 1;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    const bool separates =
        separator == ' ' ? blanks.find(line[i]) != std::string_view::npos : line[i] == separator;
    if (separates && !quoted) add(i);
  }
  add(line.size());
  return !quoted;
}

std::vector<std::string> fields(std::string_view line, Separator separator) {
  std::vector<std::string_view> cells;
  split_cells(line, separator, cells);
  return {cells.begin(), cells.end()};
}

std::string_view without_comment(std::string_view line) {
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (line[i] == '#' && !quoted) return line.substr(0, i);
  }
  return line;
}

std::optional<double> number_of(std::string_view text) {
  const auto value = parsed<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int> integer_of(std::string_view text) { return parsed<int>(text); }

std::string why_no_number(std::string_view text) {
  text = base::trim(text);
  if (text.empty()) return "a number is missing";
  std::string cell(text.substr(0, shown));
  if (has_decimal_comma(text)) {
    std::string point = cell;
    std::ranges::replace(point, ',', '.');
    const bool one = std::ranges::count(point, '.') == 1;
    return fmt::format("'{}' has a decimal comma; write {}", cell,
                       one ? point : "numbers with a decimal point");
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range)
    return fmt::format("'{}' is beyond the range of numbers", cell);
  if (error == std::errc() && end == text.data() + text.size() && !std::isfinite(value))
    return fmt::format("'{}' is not a finite number", cell);
  return fmt::format("'{}' is not a number", cell);
}

Heading heading_of(std::string_view cell) {
  const std::size_t open = cell.find('[');
  Heading heading{std::string(base::trim(cell.substr(0, open))), {}};
  if (open != std::string_view::npos) {
    const std::string_view rest = cell.substr(open + 1);
    heading.unit = base::trim(rest.substr(0, rest.find(']')));
  }
  return heading;
}

}  // namespace couplet::csv
