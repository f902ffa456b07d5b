// SPDX-License-Identifier: Apache-2.0
#include "common/fv/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/csv/csv_reader.hpp"

namespace couplet::fv {

namespace {

constexpr std::size_t most_rows = 1000000;  // 24 bytes each in every key that names the file

/// Index (from 0) of the requested column, out of `n`.
std::size_t find_column(const std::filesystem::path& file, const std::vector<std::string>& names,
                        const std::string& column, std::size_t n) {
  if (const auto number = csv::number_of(column); number && *number == std::floor(*number)) {
    if (n < 2) throw Error("{}: a table needs two columns, points and values; found one.", file.string());
    if (*number < 2 || *number > double(n))
      throw Error("{}: the table's values must be in a column from 2 to {}, not in '{}'.", file.string(), n,
                  column);
    return static_cast<std::size_t>(*number) - 1;
  }
  auto found = std::ranges::find(names, column);
  const auto is_called = [&](const std::string& n) {
    return n == column || csv::heading_of(n).name == column;
  };
  if (found == names.end()) found = std::ranges::find_if(names, is_called);
  if (found != names.end()) {
    if (found == names.begin())
      throw Error(
          "{}: '{}' is the first column, which contains the table's points; the values must be in another one.",
          file.string(), column);
    if (std::find_if(found + 1, names.end(), is_called) != names.end())
      throw Error("{}: more than one column is called '{}'. Give its number.", file.string(), column);
    return static_cast<std::size_t>(found - names.begin());
  }
  throw Error("{}: the table's column '{}' does not exist. {}", file.string(), column,
              names.empty() ? "Its first line contains no names; give the number of a column, from 2."
                            : base::did_you_mean(column, names, "columns"));
}

/// Throws Error if a name has its unit where it is not read: in round brackets, a known one as in "p(Pa)" or one
/// word after a blank as in "p (psi)", or behind a line as in "p_kPa".
void check_place_of_unit(const csv::CsvReader& rows, const std::string& name) {
  const auto known = [](std::string_view text) -> std::optional<base::Unit> {
    try {
      return base::parse_unit(text);
    } catch (const Error&) {
      return std::nullopt;
    }
  };
  const std::size_t open = name.rfind('('), line = name.rfind('_');
  if (name.ends_with(')') && open != std::string::npos) {
    const std::string unit(base::trim(std::string_view(name).substr(open + 1, name.size() - open - 2)));
    const bool is_word = open > 0 && name[open - 1] == ' ' && unit.find(' ') == std::string::npos;
    if (!unit.empty() && !csv::number_of(unit) && (is_word || known(unit)))
      throw Error("{}: '{}' has its unit in round brackets, where it is not read. Write '{}[{}]'.",
                  rows.place_of_names(), name, name.substr(0, open), unit);
  } else if (line != std::string::npos && name.size() > line + 2) {
    // A single letter, as in t_h, may be an index, min a minimum, and p_atm the pressure of the atmosphere.
    const std::string unit = name.substr(line + 1);
    const auto is = unit == "min" || unit == "atm" ? std::nullopt : known(unit);
    if (is && !is->is_number() && (is->factor != 1 || is->offset != 0))
      throw Error("{}: '{}' ends with a unit, which is not read there. Write '{}[{}]', or another name.",
                  rows.place_of_names(), name, name.substr(0, line), unit);
  }
}

}  // namespace

// Relative rounding of the ends of a period in a file.
constexpr double period_rounding = 1e-6;

Table::Table(std::vector<double> at, std::vector<double> values, Outside outside, std::string where,
             double period)
    : at_(std::move(at)),
      values_(std::move(values)),
      outside_(outside),
      period_(period),
      where_(std::move(where)) {
  const std::string place = where_.empty() ? "" : where_ + ": ";
  if (at_.empty() || at_.size() != values_.size())
    throw Error("{}a table needs one value per point; {} values for {} points are given.", place,
                values_.size(), at_.size());
  for (std::size_t i = 1; i < at_.size(); ++i)
    if (!(at_[i] > at_[i - 1]))
      throw Error("{}the points of a table must increase, but {:g} is followed by {:g}.", place, at_[i - 1],
                  at_[i]);
  if (repeats()) close(place);
  integral_.assign(at_.size(), 0);
  for (std::size_t i = 1; i < at_.size(); ++i)
    integral_[i] = integral_[i - 1] + 0.5 * (values_[i] + values_[i - 1]) * (at_[i] - at_[i - 1]);
}

/// Ends the points one period after the first one, with its value.
void Table::close(const std::string& place) {
  const double span = at_.back() - at_.front();
  if (span > period_ * (1 + period_rounding))
    throw Error("{}the table covers {:g}, which is longer than the period of {:g} with which it repeats.",
                place, span, period_);
  if (span < period_ * (1 - period_rounding)) {
    at_.push_back(at_.front() + period_);
    values_.push_back(values_.front());
    return;
  }
  const auto [low, high] = std::ranges::minmax(values_);
  if (std::abs(values_.back() - values_.front()) > period_rounding * std::max(std::abs(low), std::abs(high)))
    throw Error(
        "{}the table repeats with a period of {:g}, but its values at both ends of the period differ: {:g} and {:g}. Give "
        "both the same value, or leave out the last row; values between the last row and the end of the period are linear.",
        place, period_, values_.front(), values_.back());
  at_.back() = at_.front() + period_;
  values_.back() = values_.front();
}

double Table::periods_before(double at) const {
  return repeats() ? std::floor((at - at_.front()) / period_) : 0;
}

void Table::check_inside(double at) const {
  if (repeats() || outside_ == Outside::clamp || (at >= at_.front() && at <= at_.back())) return;
  throw Error(
      "{}the table covers {:g} to {:g}, but its value at {:g} is needed. Extend it, or use 'outside: clamp' "
      "to hold its end values.",
      where_.empty() ? "" : where_ + ": ", at_.front(), at_.back(), at);
}

double Table::operator()(double at) const {
  check_inside(at);
  return inside(at - periods_before(at) * period_);
}

double Table::inside(double at) const {
  if (at <= at_.front()) return values_.front();
  if (at >= at_.back()) return values_.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(at_.begin(), at_.end(), at) - at_.begin());
  const double part = (at - at_[i - 1]) / (at_[i] - at_[i - 1]);
  return values_[i - 1] + part * (values_[i] - values_[i - 1]);
}

double Table::antiderivative(double at) const {
  if (repeats()) {
    const double periods = periods_before(at), whole = periods * integral_.back();
    at = std::clamp(at - periods * period_, at_.front(), at_.back());
    if (at <= at_.front()) return whole;
    const auto i = static_cast<std::size_t>(std::lower_bound(at_.begin(), at_.end(), at) - at_.begin());
    return whole + integral_[i - 1] + 0.5 * (at - at_[i - 1]) * (values_[i - 1] + inside(at));
  }
  if (at <= at_.front()) return (at - at_.front()) * values_.front();
  if (at >= at_.back()) return integral_.back() + (at - at_.back()) * values_.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(at_.begin(), at_.end(), at) - at_.begin());
  return integral_[i - 1] + 0.5 * (at - at_[i - 1]) * (values_[i - 1] + inside(at));
}

double Table::integral(double from, double to) const {
  check_inside(from);
  check_inside(to);
  return antiderivative(to) - antiderivative(from);
}

Table read_table(const std::filesystem::path& file, const std::string& column, Table::Outside outside,
                 double period) {
  csv::CsvReader rows(file, "table");
  const std::vector<std::string>& names = rows.names();
  std::vector<double> at, values;
  std::optional<std::size_t> wanted;
  while (rows.next()) {
    if (!wanted) {
      wanted = find_column(file, names, column, rows.cells().size());
      for (const std::size_t i : {std::size_t(0), *wanted})
        if (i < names.size()) check_place_of_unit(rows, names[i]);
    }
    at.push_back(rows.number(0, names.empty() ? "the point in column 1" : names[0]));
    values.push_back(rows.number(
        *wanted, names.empty() ? fmt::format("the value in column {}", *wanted + 1) : names[*wanted]));
    if (at.size() > 1 && !(at.back() > at[at.size() - 2]))
      throw Error("{}: the first column of a table must increase, but {:g} is followed by {:g}.",
                  rows.place(), at[at.size() - 2], at.back());
    if (at.size() > most_rows)
      throw Error("{}: a table has at most {} rows. Reduce them.", rows.place(), most_rows);
  }
  if (at.empty()) throw Error("{}: this table contains no rows of numbers.", file.string());
  Table table(std::move(at), std::move(values), outside, file.string(), period);
  const auto unit_of = [&](std::size_t column) {
    return column < names.size() ? csv::heading_of(names[column]).unit : std::string();
  };
  table.units_ = {unit_of(0), unit_of(*wanted)};
  return table;
}

Property::Property(const config::ExpressionText& text, const std::string& where, std::string_view variable) {
  const std::string place = where.empty() ? "" : where + ": ";
  if (const auto number = csv::number_of(text.text)) {
    constant_ = *number;
    return;
  }
  std::deque<Table> tables;
  std::string rest;
  try {
    rest = take_tables(text.text, tables, text.key.unit);
  } catch (const TextProblem& problem) {
    if (problem.is_sentence) throw Error("{}{}", place, problem.what);
    throw Error("{}cannot parse '{}' at column {}: {}.", place, text.text, problem.at + 1, problem.what);
  }
  const bool is_table = tables.size() == 1 && rest.starts_with("tab00(") && rest.ends_with(")") &&
                        base::trim(std::string_view(rest).substr(6, rest.size() - 7)) == variable;
  if (!is_table && variable != "T")
    throw Error("{}'{}' is no table of {}, such as {{of: {}, at: [0, 1], values: [0, 2]}}.", place, text.text,
                variable, variable);
  if (!is_table)
    throw Error(
        "{}'{}' is neither a number nor a table of the temperature, such as {{of: T, at: [300 K, 600 K], "
        "values: [210 GPa, 180 GPa]}}.",
        place, text.text);
  if (tables.front().repeats())
    throw Error("{}a table of {} does not repeat; remove 'repeat'.", place, variable);
  for (const double value : tables.front().values())
    if (!text.key.contain(value))
      throw Error("{}{} is out of range in a table; expected a value {}.", place,
                  base::format_quantity(value, text.key.unit), config::describe_range(text.key));
  table_.push_back(std::move(tables.front()));
  use_ = &uses()[fmt::format("{} {}", where, text.text)];
  use_->kind = variable == "T" ? Use::Kind::property : Use::Kind::table;
  use_->from = table_[0].at().front();
  use_->to = table_[0].at().back();
}

std::string problem_of_property(const config::ExpressionText& text, std::string_view variable) {
  try {
    const Property property(text, "", variable);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

// Tables in the text of expressions.

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
  double period = 0;
  if (i < arguments.size() && (arguments[i].text == "clamp" || arguments[i].text == "error")) {
    outside = arguments[i++].text == "error" ? Table::Outside::error : Table::Outside::clamp;
  } else if (i < arguments.size() && arguments[i].text.starts_with("repeat")) {
    const Argument after{arguments[i].at + 6, std::string(base::trim(arguments[i].text.substr(6)))};
    period = number(after);
    if (!(period > 0))
      throw TextProblem{after.at, fmt::format("the period of a table must be above 0, not {:g}", period),
                        false};
    ++i;
  }
  if (i >= arguments.size() || arguments[0].text.empty())
    throw TextProblem{begin, "a table has the form table(t, 0, 10, 5, 20): the variable first, then pairs",
                      false};
  try {
    if (arguments[i].text.starts_with('"')) {
      if (arguments.size() > i + 2)
        throw TextProblem{arguments[i + 2].at, "the file of a table is followed by at most one column",
                          false};
      return read_table(unquoted(arguments[i].text),
                        i + 1 < arguments.size() ? unquoted(arguments[i + 1].text) : "2", outside, period);
    }
    if ((arguments.size() - i) % 2 != 0)
      throw TextProblem{arguments.back().at, "a table needs pairs: a value for each point", false};
    std::vector<double> at, values;
    for (; i < arguments.size(); i += 2) {
      at.push_back(number(arguments[i]));
      values.push_back(number(arguments[i + 1]));
    }
    return Table(std::move(at), std::move(values), outside, "", period);
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

/// Returns true if numbers under this heading are in `unit` (empty means any in SI), if the heading has no unit, or
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
