// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/flow_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/csv/csv_reader.hpp"

namespace couplet::thermocline {
namespace {

struct FlowColumn {
  const char *name, *unit, *example;
  bool required;
};
constexpr std::array<FlowColumn, 5> known{{{"time", "s", "h", true},
                                           {"mass-flow", "kg/s", "kg/s", true},
                                           {"inlet-temperature", "K", "degC", true},
                                           {"stop-above", "K", "degC", false},
                                           {"stop-below", "K", "degC", false}}};

/// The columns of one file and what turns their numbers into SI.
class FlowColumns {
 public:
  FlowColumns(const std::vector<std::string>& head, const std::string& place) {
    std::vector<std::string> names;
    for (const FlowColumn& c : known) names.emplace_back(c.name);
    for (std::size_t i = 0; i < head.size(); ++i) {
      const csv::Heading heading = csv::heading_of(head[i]);
      const auto found = std::find(names.begin(), names.end(), heading.name);
      if (found == names.end())
        throw Error("{}: unknown column '{}'. {}", place, head[i].substr(0, 80),
                    base::did_you_mean(heading.name, names, "columns"));
      const auto c = std::size_t(found - names.begin());
      if (at_[c]) throw Error("{}: the column '{}' appears twice.", place, heading.name);
      at_[c] = i;
      unit_[c] = unit_of(known[c], heading.unit, place);
    }
    for (std::size_t c = 0; c < known.size(); ++c)
      if (known[c].required && !at_[c])
        throw Error("{}: the column '{}' is missing. A flow file has the columns {}.", place, known[c].name,
                    base::join(names));
  }

  /// Value [SI] of a column in a row; nothing where it is empty.
  std::optional<double> value(const csv::CsvReader& row, std::size_t c) const {
    if (!at_[c] || row.cells()[*at_[c]].empty()) return {};
    return row.number(*at_[c], known[c].name) * unit_[c].factor + unit_[c].offset;
  }

 private:
  /// Heads without a unit would leave open whether 290 is in K or degC.
  static base::Unit unit_of(const FlowColumn& column, const std::string& text, const std::string& place) {
    if (text.empty())
      throw Error("{}: the unit of the column '{}' is missing; write for example '{} [{}]'.", place,
                  column.name, column.name, column.example);
    const auto wanted = base::parse_unit(column.unit);
    try {
      const base::Unit unit = base::parse_unit(text);
      if (unit.dimension == wanted.dimension) return unit;
    } catch (const Error& error) {
      throw Error("{}: column '{}': {}", place, column.name, error.what());
    }
    throw Error("{}: the unit '{}' of the column '{}' is not one of {}.", place, text, column.name,
                column.unit);
  }

  std::array<std::optional<std::size_t>, known.size()> at_;
  std::array<base::Unit, known.size()> unit_;
};

ScheduleRow row_of(const FlowColumns& columns, const csv::CsvReader& row) {
  const std::string place = row.place();
  std::array<std::optional<double>, known.size()> v;
  for (std::size_t c = 0; c < known.size(); ++c) v[c] = columns.value(row, c);
  for (const std::size_t c : {0, 1})
    if (!v[c]) throw Error("{}: {} is empty.", place, known[c].name);
  if (*v[0] < 0) throw Error("{}: time {:g} s is before the start.", place, *v[0]);
  constexpr double coldest = 100, hottest = 3000;  // [K]
  if (v[2] && !(*v[2] >= coldest && *v[2] <= hottest))
    throw Error("{}: inlet-temperature is {:g} K; expected {:g} to {:g} K.", place, *v[2], coldest, hottest);
  if (*v[1] != 0 && !v[2])
    throw Error("{}: inlet-temperature is missing; specify the temperature of this inflow.", place);
  return {*v[0], *v[1], v[2].value_or(0), v[3], v[4]};
}

}  // namespace

std::vector<ScheduleRow> read_flow_file(const std::filesystem::path& file) {
  csv::CsvReader reader(file, "flow file");
  if (reader.names().empty())
    throw Error("{}: the first line of a flow file must name its columns with units, such as 'time [h]'.",
                file.string());
  const FlowColumns columns(reader.names(), reader.place_of_names());
  std::vector<ScheduleRow> rows;
  while (reader.next()) {
    rows.push_back(row_of(columns, reader));
    if (rows.size() > 1 && rows.back().at <= rows[rows.size() - 2].at)
      throw Error("{}: time {:g} s is not after that of the previous row, {:g} s.", reader.place(),
                  rows.back().at, rows[rows.size() - 2].at);
  }
  if (rows.empty()) throw Error("{}: this flow file has no rows.", file.string());
  return rows;
}

}  // namespace couplet::thermocline
