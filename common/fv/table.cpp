// SPDX-License-Identifier: Apache-2.0
#include "common/fv/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
          "{}: '{}' is the first column, which holds the table's points; the values must be in another one.",
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
    // A single letter, as in t_h, may be an index, and min a minimum.
    const std::string unit = name.substr(line + 1);
    const auto is = unit == "min" ? std::nullopt : known(unit);
    if (is && !is->is_number() && (is->factor != 1 || is->offset != 0))
      throw Error("{}: '{}' ends with a unit, which is not read there. Write '{}[{}]', or another name.",
                  rows.place_of_names(), name, name.substr(0, line), unit);
  }
}

}  // namespace

Table::Table(std::vector<double> at, std::vector<double> values, Outside outside, std::string where)
    : at_(std::move(at)),
      values_(std::move(values)),
      integral_(at_.size(), 0),
      outside_(outside),
      where_(std::move(where)) {
  const std::string place = where_.empty() ? "" : where_ + ": ";
  if (at_.empty() || at_.size() != values_.size())
    throw Error("{}a table needs one value per point; {} values for {} points are given.", place,
                values_.size(), at_.size());
  for (std::size_t i = 1; i < at_.size(); ++i) {
    if (!(at_[i] > at_[i - 1]))
      throw Error("{}the points of a table must increase, but {:g} is followed by {:g}.", place, at_[i - 1],
                  at_[i]);
    integral_[i] = integral_[i - 1] + 0.5 * (values_[i] + values_[i - 1]) * (at_[i] - at_[i - 1]);
  }
}

void Table::check_inside(double at) const {
  if (outside_ == Outside::clamp || (at >= at_.front() && at <= at_.back())) return;
  throw Error(
      "{}the table covers {:g} to {:g}, but its value at {:g} is needed. Extend it, or use 'outside: clamp' "
      "to hold its end values.",
      where_.empty() ? "" : where_ + ": ", at_.front(), at_.back(), at);
}

double Table::operator()(double at) const {
  check_inside(at);
  return inside(at);
}

double Table::inside(double at) const {
  if (at <= at_.front()) return values_.front();
  if (at >= at_.back()) return values_.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(at_.begin(), at_.end(), at) - at_.begin());
  const double part = (at - at_[i - 1]) / (at_[i] - at_[i - 1]);
  return values_[i - 1] + part * (values_[i] - values_[i - 1]);
}

double Table::antiderivative(double at) const {
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

Table read_table(const std::filesystem::path& file, const std::string& column, Table::Outside outside) {
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
  Table table(std::move(at), std::move(values), outside, file.string());
  const auto unit_of = [&](std::size_t column) {
    return column < names.size() ? csv::heading_of(names[column]).unit : std::string();
  };
  table.units_ = {unit_of(0), unit_of(*wanted)};
  return table;
}

Property::Property(const config::ExpressionText& text, const std::string& where) {
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
                        base::trim(std::string_view(rest).substr(6, rest.size() - 7)) == "T";
  if (!is_table)
    throw Error(
        "{}'{}' is neither a number nor a table of the temperature, such as {{of: T, at: [300 K, 600 K], "
        "values: [210 GPa, 180 GPa]}}.",
        place, text.text);
  for (const double value : tables.front().values())
    if (!text.key.contain(value))
      throw Error("{}{} is out of range in a table; expected a value {}.", place,
                  base::format_quantity(value, text.key.unit), config::describe_range(text.key));
  table_.push_back(std::move(tables.front()));
  use_ = &uses()[fmt::format("{} {}", where, text.text)];
  use_->kind = Use::Kind::property;
  use_->from = table_[0].at().front();
  use_->to = table_[0].at().back();
}

std::string problem_of_property(const config::ExpressionText& text) {
  try {
    const Property property(text, "");
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

}  // namespace couplet::fv
