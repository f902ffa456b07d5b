// SPDX-License-Identifier: Apache-2.0
// Tables in the text of expressions.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/fv/table.hpp"

namespace couplet::fv {
namespace {

constexpr std::string_view name = "table";
constexpr std::size_t most_tables = 100;  // two digits in tabNN

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Start of the last call of table(, which contains no other call, or npos.
std::size_t last_call(const std::string& text) {
  for (std::size_t at = text.rfind(name); at != std::string::npos;) {
    const std::size_t after = text.find_first_not_of(' ', at + name.size());
    const bool whole_word = at == 0 || !in_word(text[at - 1]);
    if (whole_word && after == at + name.size() && text[after] == '(') return at;
    if (at == 0) break;
    at = text.rfind(name, at - 1);
  }
  return std::string::npos;
}

struct Argument {
  std::size_t at;
  std::string text;
};

/// Arguments of the call whose '(' is at `open`. Sets `close` to the position of its ')'.
std::vector<Argument> arguments_of(const std::string& text, std::size_t open, std::size_t& close) {
  std::vector<Argument> arguments;
  std::size_t first = open + 1;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = open + 1; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted) continue;
    if (text[i] == '(') ++depth;
    if (depth == 0 && (text[i] == ',' || text[i] == ')')) {
      first = std::min(text.find_first_not_of(' ', first), i);
      arguments.push_back({first, std::string(base::trim(std::string_view(text).substr(first, i - first)))});
      first = i + 1;
      if (text[i] == ')') {
        close = i;
        return arguments;
      }
    }
    if (text[i] == ')') --depth;
  }
  throw TextProblem{text.size(), "missing ')' or '\"' of a table", false};
}

double number(const Argument& argument) {
  if (const auto value = csv::number_of(argument.text)) return *value;
  throw TextProblem{argument.at, fmt::format("a table contains numbers, not '{}'", argument.text), false};
}

std::string unquoted(const std::string& text) {
  return text.size() >= 2 && text.front() == '"' && text.back() == '"' ? text.substr(1, text.size() - 2)
                                                                       : text;
}

Table table_from(const std::vector<Argument>& arguments, std::size_t begin) {
  std::size_t i = 1;
  Table::Outside outside = Table::Outside::clamp;
  if (i < arguments.size() && (arguments[i].text == "clamp" || arguments[i].text == "error"))
    outside = arguments[i++].text == "error" ? Table::Outside::error : Table::Outside::clamp;
  if (i >= arguments.size() || arguments[0].text.empty())
    throw TextProblem{begin, "a table has the form table(t, 0, 10, 5, 20): the variable first, then pairs",
                      false};
  try {
    if (arguments[i].text.starts_with('"')) {
      if (arguments.size() > i + 2)
        throw TextProblem{arguments[i + 2].at, "the file of a table is followed by at most one column",
                          false};
      return read_table(unquoted(arguments[i].text),
                        i + 1 < arguments.size() ? unquoted(arguments[i + 1].text) : "2", outside);
    }
    if ((arguments.size() - i) % 2 != 0)
      throw TextProblem{arguments.back().at, "a table needs pairs: a value for each point", false};
    std::vector<double> at, values;
    for (; i < arguments.size(); i += 2) {
      at.push_back(number(arguments[i]));
      values.push_back(number(arguments[i + 1]));
    }
    return Table(std::move(at), std::move(values), outside, "");
  } catch (const Error& e) {
    throw TextProblem{begin, e.what(), true};
  }
}

/// Returns true if numbers under this heading are in `unit`, or if the heading has no unit. One that is not
/// known ("psi") is another. An empty `unit` means any in SI.
bool is_in_unit(const std::string& heading, std::string_view unit) {
  if (heading.empty() || heading == "-" || heading == unit) return true;
  try {
    const base::Unit given = unit.empty() ? base::parse_unit(heading) : base::parse_unit(heading, unit);
    return given.factor == (unit.empty() ? 1 : base::parse_unit(unit).factor) && given.offset == 0;
  } catch (const Error&) {
    return false;
  }
}

/// Rejects a header in another unit. The numbers of a file are used unchanged, so they must be in SI if the
/// variable is bare, and in the unit of the key if the table is the whole value.
void check_units(const Table& table, const std::string& variable, std::optional<std::string_view> unit,
                 std::size_t at) {
  static const std::map<std::string, std::string> unit_of_variable{
      {"x", "m"}, {"y", "m"}, {"z", "m"}, {"sqrt(x^2 + y^2)", "m"}, {"t", "s"}, {"T", "K"}};
  const auto known = unit_of_variable.find(variable);
  if (known != unit_of_variable.end() && !is_in_unit(table.units().axis, known->second))
    throw TextProblem{
        at,
        fmt::format(
            "{}: the first column is in '{}', but '{}' is in {}. Convert the column, or write the variable "
            "in its unit, such as table(t/3600, \"file.csv\") for hours.",
            table.where(), table.units().axis, variable, known->second),
        true};
  if (unit && !is_in_unit(table.units().value, *unit))
    throw TextProblem{
        at,
        fmt::format("{}: the values are in '{}', but a table's values are taken in {}. Convert "
                    "the column, or scale it, such as \"1e5*table(t, \\\"file.csv\\\")\" for bar.",
                    table.where(), table.units().value, unit->empty() ? "SI units" : *unit),
        true};
}

}  // namespace

std::string take_tables(const std::string& text, std::deque<Table>& tables, std::string_view unit) {
  std::string rest = text;
  for (std::size_t begin = last_call(rest); begin != std::string::npos; begin = last_call(rest)) {
    if (tables.size() == most_tables) throw TextProblem{begin, "there are more than 100 tables", false};
    std::size_t close = 0;
    const std::vector<Argument> arguments = arguments_of(rest, begin + name.size(), close);
    tables.push_back(table_from(arguments, begin));
    std::string call = fmt::format("tab{:02}({}", tables.size() - 1, arguments[0].text);
    call.resize(close - begin, ' ');
    const bool is_whole_value = rest.find_first_not_of(" (") == begin && rest.find_last_not_of(" )") < close;
    check_units(tables.back(), arguments[0].text, is_whole_value ? std::optional(unit) : std::nullopt, begin);
    rest.replace(begin, close - begin, call);
  }
  return rest;
}

}  // namespace couplet::fv
