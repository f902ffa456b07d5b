// SPDX-License-Identifier: Apache-2.0
#include "common/csv/csv_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::csv {

namespace {

constexpr std::string_view blanks = " \t";
constexpr std::size_t shown = 60;  // of a cell in messages

/// Removes one pair of quotes.
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

/// Detects digits with commas, signs and points: a number in another locale.
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

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Detects an intended number, even if invalid: "0,5", "-", "1.2.3", "nan".
bool is_like_number(std::string_view cell) {
  constexpr std::string_view of_numbers = "0123456789.,+-eE";
  if (number_of(cell)) return true;
  std::string lower(cell);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (lower.starts_with('-') || lower.starts_with('+')) lower.erase(0, 1);
  if (lower == "nan" || lower == "inf" || lower == "infinity") return true;
  return std::ranges::any_of(cell, is_digit) && cell.find_first_not_of(of_numbers) == std::string_view::npos;
}

/// Detects "05", which follows a decimal comma and is not a number of its own.
bool has_leading_zero(std::string_view cell) {
  return cell.size() > 1 && cell[0] == '0' && std::ranges::all_of(cell, is_digit);
}

const char* word_for(Separator separator) {
  switch (separator) {
    case ';':
      return "semicolons";
    case ',':
      return "commas";
    case '\t':
      return "tabs";
    default:
      return "blanks";
  }
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file, const std::string& kind, const Limits& limits)
    : lines_(file, kind, limits) {
  if (!next_line()) return;
  first_line_ = line();
  take_names();
  row_waits_ = names_.empty();
}

std::string CsvReader::place_of_names() const { return fmt::format("{}:{}", lines_.name(), line_of_names_); }

/// Reads the next line that contains cells.
bool CsvReader::next_line() {
  for (std::string_view text; lines_.next(text);) {
    text = without_comment(text);
    if (base::trim(text).empty()) continue;
    if (width_ == 0) separator_ = separator_of(text);
    if (!split_cells(text, separator_, cells_)) throw Error("{}: a double quote is not closed.", place());
    if (width_ == 0) width_ = cells_.size();
    return true;
  }
  return false;
}

/// Takes the first row as names only if none looks like a number, so that a faulty row is not accepted.
void CsvReader::take_names() {
  const auto number = std::ranges::find_if(cells_, is_like_number);
  if (number == cells_.end()) {
    names_.assign(cells_.begin(), cells_.end());
    line_of_names_ = line();
    return;
  }
  for (const std::string_view cell : cells_)
    if (!cell.empty() && !is_like_number(cell))
      throw Error(
          "{}: the first line contains both numbers ('{}') and words ('{}'): are these column names or "
          "values? {}.",
          place(), number->substr(0, 60), cell.substr(0, 60),
          cell.find_first_of("0123456789") == 0
              ? "Write numbers without units; a unit belongs in the column name, as in 'time [s]'"
              : "Give every column a name that is not a number, or omit the names");
}

void CsvReader::check_width() const {
  if (cells_.size() == width_) return;
  const bool commas = separator_ == ',' && cells_.size() > width_;
  const bool other = cells_.size() == 1 && separator_of(cells_[0]) != ' ';
  throw Error("{}: {} values, but the file has {} columns (separated by {}, as in line {}).{}", place(),
              cells_.size(), width_, word_for(separator_), first_line_,
              commas  ? " If commas are decimal commas, use decimal points."
              : other ? " Use one separator throughout the file."
                      : "");
}

/// Rejects "0,5,1000" without names: three numbers, or 0.5 and 1000?
void CsvReader::refuse_ambiguous() const {
  if (!names_.empty() || separator_ != ',' || width_ < 3 || has_points_) return;
  throw Error(
      "{}:{}: ambiguous commas: they may separate {} whole numbers or be decimal commas. Name the columns "
      "in the first line, or use semicolons as separators and decimal points.",
      lines_.name(), first_line_, width_);
}

bool CsvReader::next() {
  if (!row_waits_ && !next_line()) {
    if (first_line_ > 0) refuse_ambiguous();
    return false;
  }
  row_waits_ = false;
  check_width();
  if (separator_ == ',' && names_.empty() && !has_points_)
    has_points_ = std::ranges::any_of(
        cells_, [](std::string_view cell) { return cell.find_first_of(".eE") != std::string_view::npos; });
  return true;
}

double CsvReader::number(std::size_t column, std::string_view what) const {
  const std::string_view cell = cells_.at(column);
  const auto value = number_of(cell);
  if (value && !(separator_ == ',' && has_leading_zero(cell))) return *value;
  const std::string expected = what.empty() ? "" : fmt::format("; expected {} here", what);
  if (value)
    throw Error(
        "{}: '{}' starts with a zero: are the commas decimal commas? Use decimal points, and numbers "
        "without leading zeros{}.",
        place(), cell.substr(0, 60), expected);
  throw Error("{}: {}{}.", place(), why_no_number(cell), expected);
}

}  // namespace couplet::csv
