// SPDX-License-Identifier: Apache-2.0
#include "common/fv/grid_table.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/csv/csv_reader.hpp"

namespace couplet::fv {
namespace {

constexpr std::array<const char*, 4> axis_names{"x", "y", "z", "t"};
constexpr std::array<const char*, 4> axis_units{"m", "m", "m", "s"};
constexpr double most_places = 1e7;
constexpr std::size_t most_numbers = 10000000;

struct Columns {
  std::array<int, 4> axis{-1, -1, -1, -1};
  std::vector<int> value;
};

Columns columns_of(const csv::CsvReader& reader, const std::vector<std::string>& values) {
  const std::vector<std::string>& head = reader.names();
  const std::string place = reader.place_of_names();
  Columns columns;
  columns.value.assign(values.size(), -1);
  std::vector<std::string> known(axis_names.begin(), axis_names.end());
  known.insert(known.end(), values.begin(), values.end());
  for (std::size_t i = 0; i < head.size(); ++i) {
    const auto [name, unit] = csv::heading_of(head[i]);
    const auto found = std::ranges::find(known, name);
    if (found == known.end())
      throw Error("{}: unknown column '{}'. {}", place, name, base::did_you_mean(name, known, "columns"));
    const auto at = static_cast<std::size_t>(found - known.begin());
    // A header in other units would be misinterpreted.
    const std::string wanted = at < axis_names.size() ? axis_units[at] : "m/s";
    if (head[i].find('[') != std::string::npos && unit != wanted)
      throw Error("{}: the column '{}' is in '{}'; only {} is accepted here.", place, name, unit, wanted);
    int& column = at < axis_names.size() ? columns.axis[at] : columns.value[at - axis_names.size()];
    if (column >= 0) throw Error("{}: the column '{}' appears twice.", place, name);
    column = static_cast<int>(i);
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    if (columns.value[i] < 0)
      throw Error("{}: the column '{}' is missing; the first line must name the columns, such as 'y,t,{}'.",
                  place, values[i], base::join(values, ","));
  if (std::ranges::all_of(columns.axis, [](int c) { return c < 0; }))
    throw Error("{}: no column is an axis; name at least one of them x, y, z or t.", place);
  return columns;
}

/// Numbers row by row, one per column of the file.
struct NumberRows {
  std::size_t width = 0;
  std::vector<double> values;
  std::vector<int> line;
  std::size_t size() const { return line.size(); }
  double operator()(std::size_t row, int column) const { return values[row * width + std::size_t(column)]; }
};

NumberRows rows_of(csv::CsvReader& reader) {
  NumberRows rows{reader.names().size(), {}, {}};
  while (reader.next()) {
    for (std::size_t i = 0; i < rows.width; ++i) rows.values.push_back(reader.number(i, reader.names()[i]));
    rows.line.push_back(reader.line());
    if (rows.values.size() > most_numbers)
      throw Error("{}: a grid table has at most {:g} numbers. Use fewer points.", reader.place(),
                  double(most_numbers));
  }
  return rows;
}

std::size_t place_on(const std::vector<double>& axis, double at) {
  return static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), at) - axis.begin());
}

}  // namespace

GridTable GridTable::read(const std::filesystem::path& file, const std::vector<std::string>& values,
                          Outside outside, double period) {
  csv::CsvReader reader(file, "table");
  if (reader.names().empty())
    throw Error("{}: the first line must name the columns, such as 'y,t,{}'.", file.string(),
                base::join(values, ","));
  const Columns columns = columns_of(reader, values);
  const NumberRows rows = rows_of(reader);
  if (rows.size() == 0) throw Error("{}: the table has no values.", file.string());
  GridTable table;
  table.file_ = file.string();
  table.outside_ = outside;
  table.period_ = period;
  table.n_values_ = values.size();
  double places = 1;
  for (int a = 0; a < n_axes; ++a) {
    if (columns.axis[a] < 0) continue;
    std::vector<double>& axis = table.axes_[a];
    for (std::size_t r = 0; r < rows.size(); ++r) axis.push_back(rows(r, columns.axis[a]));
    std::ranges::sort(axis);
    axis.erase(std::unique(axis.begin(), axis.end()), axis.end());
    places *= double(axis.size());
  }
  if (places > most_places)
    throw Error(
        "{}: its axes span {:.3g} points; does every line have its own coordinates? A table must be "
        "a full grid.",
        file.string(), places);
  table.data_.assign(static_cast<std::size_t>(places) * values.size(), 0.0);
  std::vector<char> there(static_cast<std::size_t>(places), 0);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::size_t at = 0;
    for (int a = 0; a < n_axes; ++a)
      if (columns.axis[a] >= 0)
        at = at * table.axes_[a].size() + place_on(table.axes_[a], rows(r, columns.axis[a]));
    if (there[at])
      throw Error("{}:{}: duplicate grid point; an earlier line has the same coordinates.", file.string(),
                  rows.line[r]);
    there[at] = 1;
    for (std::size_t v = 0; v < values.size(); ++v)
      table.data_[at * values.size() + v] = rows(r, columns.value[v]);
  }
  const auto missing = std::ranges::find(there, 0);
  if (missing == there.end()) {
    if (period > 0) table.check_period();
    return table;
  }
  std::size_t at = static_cast<std::size_t>(missing - there.begin());
  std::string where;
  for (int a = n_axes - 1; a >= 0; --a) {
    const std::vector<double>& axis = table.axes_[a];
    if (axis.empty()) continue;
    where =
        fmt::format("{} = {:g}{}{}", axis_names[a], axis[at % axis.size()], where.empty() ? "" : ", ", where);
    at /= axis.size();
  }
  throw Error("{}: the grid has no value at {}; a table must be a full grid.", file.string(), where);
}

/// Times one period apart must have the same values.
void GridTable::check_period() const {
  constexpr double rounding = 1e-6;
  const std::vector<double>& times = axes_[3];
  if (times.empty()) throw Error("{}: it has no column t, so 'repeat' has no meaning; remove it.", file_);
  const double span = times.back() - times.front();
  if (span > period_ * (1 + rounding))
    throw Error(
        "{}: the table covers {:g} s, which is longer than the period of {:g} s with which it repeats.",
        file_, span, period_);
  if (span < period_ * (1 - rounding)) return;
  const std::size_t row = times.size() * n_values_, last = row - n_values_;
  double largest = 0, apart = 0;
  for (const double value : data_) largest = std::max(largest, std::abs(value));
  for (std::size_t i = 0; i < data_.size(); i += row)
    for (std::size_t v = 0; v < n_values_; ++v)
      apart = std::max(apart, std::abs(data_[i + v] - data_[i + last + v]));
  if (apart > rounding * largest)
    throw Error(
        "{}: the table repeats with a period of {:g} s, but its values at both ends of the period differ by up to {:g} m/s. "
        "Give both the same values, or leave out the last time; values between the last time and the end of the period are "
        "linear.",
        file_, period_, apart);
}

void GridTable::evaluate(const Vec3& x, double t, std::span<double> values) const {
  if (period_ > 0) t -= period_ * std::floor((t - axes_[3].front()) / period_);
  const std::array<double, n_axes> at{x[0], x[1], x[2], t};
  std::array<std::size_t, n_axes> low{};
  std::array<double, n_axes> part{};
  for (int a = 0; a < n_axes; ++a) {
    const std::vector<double>& axis = axes_[a];
    if (axis.empty()) continue;
    const bool repeats = a == 3 && period_ > 0;
    if (!repeats && outside_ == Outside::error && (at[a] < axis.front() || at[a] > axis.back()))
      throw Error("{}: the table covers {} = {:g} {} to {:g} {}, but its value at {:g} {} is needed.", file_,
                  axis_names[a], axis.front(), axis_units[a], axis.back(), axis_units[a], at[a],
                  axis_units[a]);
    if (axis.size() == 1) continue;
    if (repeats && at[a] > axis.back()) {  // on the way from the last time to the first one
      low[a] = axis.size() - 1;
      part[a] = std::min((at[a] - axis.back()) / (axis.front() + period_ - axis.back()), 1.0);
      continue;
    }
    const auto above = std::upper_bound(axis.begin(), axis.end() - 1, at[a]);
    low[a] = above == axis.begin() ? 0 : static_cast<std::size_t>(above - axis.begin()) - 1;
    part[a] = std::clamp((at[a] - axis[low[a]]) / (axis[low[a] + 1] - axis[low[a]]), 0.0, 1.0);
  }
  std::ranges::fill(values, 0.0);
  for (int corner = 0; corner < 1 << n_axes; ++corner) {
    double weight = 1;
    std::size_t place = 0;
    for (int a = 0; a < n_axes; ++a) {
      const bool upper = (corner >> a & 1) != 0;
      weight *= upper ? part[a] : 1 - part[a];
      if (!axes_[a].empty()) place = place * axes_[a].size() + (low[a] + (upper ? 1 : 0)) % axes_[a].size();
    }
    if (weight == 0) continue;
    for (std::size_t v = 0; v < n_values_; ++v) values[v] += weight * data_[place * n_values_ + v];
  }
}

}  // namespace couplet::fv
