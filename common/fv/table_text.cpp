// SPDX-License-Identifier: Apache-2.0
// Tables in the text of expressions.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

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

/// Numbers that multiply the call in text[begin, close]: those of its term.
std::vector<double> factors_of(const std::string& text, std::size_t begin, std::size_t close) {
  const auto ends_term = [&](std::size_t i) {
    const bool in_number = i > 1 && std::tolower(text[i - 1]) == 'e' && !std::isalpha(text[i - 2]);
    return std::string_view("+-,?:<>=&|").find(text[i]) != std::string_view::npos && !in_number;
  };
  std::size_t first = begin, last = close + 1;
  while (first > 0 && !ends_term(first - 1)) --first;
  while (last < text.size() && !ends_term(last)) ++last;
  return numbers_in(text.substr(first, begin - first) + " " + text.substr(close + 1, last - close - 1), true);
}

/// Returns true if numbers under this heading are in `unit` (empty: any in SI), if the heading has no unit, or
/// if one of `factors` converts it, as 1e5 does bar. A unit that is not known ("psi") is another.
bool is_in_unit(const std::string& heading, std::string_view unit, const std::vector<double>& factors) {
  if (heading.empty() || heading == "-" || heading == unit) return true;
  try {
    const base::Unit given = unit.empty() ? base::parse_unit(heading) : base::parse_unit(heading, unit);
    const double factor = given.factor / (unit.empty() ? 1 : base::parse_unit(unit).factor);
    const auto is_near = [&](double f) { return std::abs(f / factor - 1) < 1e-3; };
    return given.offset == 0 && (factor == 1 || std::ranges::any_of(factors, is_near));
  } catch (const Error&) {
    return false;
  }
}

/// Rejects a header in another unit. The numbers of a file are used unchanged, so they must be in SI, in the
/// unit of the key if the table is the whole value, or be scaled beside the table or its variable.
void check_units(const Table& table, const std::string& variable, std::string_view unit,
                 const std::vector<double>& factors, std::size_t at) {
  static const std::map<std::string, std::string> unit_of_variable{
      {"x", "m"}, {"y", "m"}, {"z", "m"}, {"sqrt(x^2 + y^2)", "m"}, {"t", "s"}, {"T", "K"}};
  const auto known = unit_of_variable.find(variable);
  const std::string of_variable = known == unit_of_variable.end() ? "" : known->second;
  std::vector<double> inverse = numbers_in(variable, true);
  for (double& factor : inverse) factor = 1 / factor;
  if (!is_in_unit(table.units().axis, of_variable, inverse))
    throw TextProblem{
        at,
        fmt::format(
            "{}: the first column is in '{}', but '{}' is in {}. Convert the column, or write the variable "
            "in its unit, such as table(t/3600, \"file.csv\") for hours.",
            table.where(), table.units().axis, variable, of_variable.empty() ? "SI units" : of_variable),
        true};
  if (!is_in_unit(table.units().value, unit, factors))
    throw TextProblem{
        at,
        fmt::format("{}: the values are in '{}', but a table's values are taken in {}. Convert "
                    "the column, or scale it, such as \"1e5*table(t, \\\"file.csv\\\")\" for bar.",
                    table.where(), table.units().value, unit.empty() ? "SI units" : unit),
        true};
}

}  // namespace

std::vector<double> numbers_in(std::string_view text, bool as_factors) {
  std::vector<double> numbers;
  const auto in_number = [&](std::size_t i) { return in_word(text[i]) || text[i] == '.'; };
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!in_number(i) || (i > 0 && in_number(i - 1))) continue;
    const bool divides =
        as_factors && text.substr(0, text.find_last_not_of(' ', i == 0 ? 0 : i - 1) + 1).ends_with('/');
    if (const auto quantity = base::split_quantity(text.substr(i)))
      numbers.push_back(divides ? 1 / quantity->number : quantity->number);
  }
  return numbers;
}

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
    check_units(tables.back(), arguments[0].text, is_whole_value ? unit : "", factors_of(rest, begin, close),
                begin);
    rest.replace(begin, close - begin, call);
  }
  return rest;
}

}  // namespace couplet::fv
