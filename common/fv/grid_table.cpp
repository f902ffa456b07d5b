// SPDX-License-Identifier: Apache-2.0
#include "common/fv/grid_table.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/fv/csv_line.hpp"

namespace couplet {
namespace {

constexpr std::array<const char*, 4> axis_names{"x", "y", "z", "t"};
constexpr std::array<const char*, 4> axis_units{"m", "m", "m", "s"};
constexpr double most_places = 1e8;

struct Columns {
  std::array<int, 4> axis{-1, -1, -1, -1};
  std::vector<int> value;
};

Columns columns_of(const std::filesystem::path& file, const std::vector<std::string>& head,
                   const std::vector<std::string>& values) {
  Columns columns;
  columns.value.assign(values.size(), -1);
  std::vector<std::string> known(axis_names.begin(), axis_names.end());
  known.insert(known.end(), values.begin(), values.end());
  for (std::size_t i = 0; i < head.size(); ++i) {
    const auto [name, unit] = heading_of(head[i]);
    const auto found = std::ranges::find(known, name);
    if (found == known.end())
      throw Error("{}:1: a column '{}' has no meaning here. {}", file.string(), name,
                  did_you_mean(name, known, "columns"));
    const auto at = static_cast<std::size_t>(found - known.begin());
    // A header in other units would be taken for what it is not.
    const std::string wanted = at < axis_names.size() ? axis_units[at] : "m/s";
    if (head[i].find('[') != std::string::npos && unit != wanted)
      throw Error("{}:1: the column '{}' is in '{}'; only {} is read here.", file.string(), name, unit,
                  wanted);
    int& column = at < axis_names.size() ? columns.axis[at] : columns.value[at - axis_names.size()];
    if (column >= 0) throw Error("{}:1: there are two columns '{}'.", file.string(), name);
    column = static_cast<int>(i);
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    if (columns.value[i] < 0)
      throw Error("{}:1: the column '{}' is missing; the first line names the columns, such as 'y,t,{}'.",
                  file.string(), values[i], join(values, ","));
  if (std::ranges::all_of(columns.axis, [](int c) { return c < 0; }))
    throw Error("{}:1: no column is an axis; name one of them x, y, z or t.", file.string());
  return columns;
}

std::vector<std::vector<double>> rows_of(const std::filesystem::path& file, std::vector<std::string>& head) {
  std::ifstream stream = open_table(file);
  std::vector<std::vector<double>> rows;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::vector<std::string> cells = cells_of(line, false);
    if (cells.empty()) continue;
    if (head.empty()) {
      head = cells;
      continue;
    }
    if (cells.size() != head.size())
      throw Error("{}:{}: {} columns are named, {} stand here.", file.string(), number, head.size(),
                  cells.size());
    rows.emplace_back();
    for (const std::string& cell : cells) {
      const auto value = number_of(cell);
      if (!value) throw Error("{}:{}: '{}' is not a number.", file.string(), number, cell);
      rows.back().push_back(*value);
    }
  }
  if (rows.empty()) throw Error("{}: the table has no values.", file.string());
  return rows;
}

std::size_t place_on(const std::vector<double>& axis, double at) {
  return static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), at) - axis.begin());
}

}  // namespace

GridTable GridTable::read(const std::filesystem::path& file, const std::vector<std::string>& values,
                          Outside outside) {
  std::vector<std::string> head;
  const auto rows = rows_of(file, head);
  const Columns columns = columns_of(file, head, values);
  GridTable table;
  table.file_ = file.string();
  table.outside_ = outside;
  table.n_values_ = values.size();
  double places = 1;
  for (int a = 0; a < n_axes; ++a) {
    if (columns.axis[a] < 0) continue;
    std::vector<double>& axis = table.axes_[a];
    for (const auto& row : rows) axis.push_back(row[columns.axis[a]]);
    std::ranges::sort(axis);
    axis.erase(std::unique(axis.begin(), axis.end()), axis.end());
    places *= double(axis.size());
  }
  if (places > most_places)
    throw Error("{}: its axes have {:.3g} places; is every line at another one? A table is a full grid.",
                file.string(), places);
  table.data_.assign(static_cast<std::size_t>(places) * values.size(), 0.0);
  std::vector<char> there(static_cast<std::size_t>(places), 0);
  for (const auto& row : rows) {
    std::size_t at = 0;
    for (int a = 0; a < n_axes; ++a)
      if (columns.axis[a] >= 0)
        at = at * table.axes_[a].size() + place_on(table.axes_[a], row[columns.axis[a]]);
    if (there[at]) throw Error("{}: a place of the grid is given twice.", file.string());
    there[at] = 1;
    for (std::size_t v = 0; v < values.size(); ++v)
      table.data_[at * values.size() + v] = row[columns.value[v]];
  }
  const auto missing = std::ranges::find(there, 0);
  if (missing == there.end()) return table;
  std::size_t at = static_cast<std::size_t>(missing - there.begin());
  std::string where;
  for (int a = n_axes - 1; a >= 0; --a) {
    const std::vector<double>& axis = table.axes_[a];
    if (axis.empty()) continue;
    where =
        fmt::format("{} = {:g}{}{}", axis_names[a], axis[at % axis.size()], where.empty() ? "" : ", ", where);
    at /= axis.size();
  }
  throw Error("{}: the grid has no value at {}; each place of an axis needs one at each place of the others.",
              file.string(), where);
}

void GridTable::evaluate(const Vec3& x, double t, std::span<double> values) const {
  const std::array<double, n_axes> at{x[0], x[1], x[2], t};
  std::array<std::size_t, n_axes> low{};
  std::array<double, n_axes> part{};
  for (int a = 0; a < n_axes; ++a) {
    const std::vector<double>& axis = axes_[a];
    if (axis.empty()) continue;
    if (outside_ == Outside::error && (at[a] < axis.front() || at[a] > axis.back()))
      throw Error("{}: the table goes from {} = {:g} {} to {:g} {}, but its value at {:g} {} is needed.",
                  file_, axis_names[a], axis.front(), axis_units[a], axis.back(), axis_units[a], at[a],
                  axis_units[a]);
    if (axis.size() == 1) continue;
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
      if (!axes_[a].empty()) place = place * axes_[a].size() + low[a] + (upper ? 1 : 0);
    }
    if (weight == 0) continue;
    for (std::size_t v = 0; v < n_values_; ++v) values[v] += weight * data_[place * n_values_ + v];
  }
}

}  // namespace couplet
