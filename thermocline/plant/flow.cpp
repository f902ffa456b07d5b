// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/flow.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/csv/csv_reader.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {
namespace {

void declare_row(config::Section& s, ScheduleRow& r) {
  s.value("at", r.at).unit("s", 1e-3, 1e11).not_negative().required().doc("start time of the row");
  s.value("mass-flow", r.mass_flow)
      .unit("kg/s", 1e-6, 1e5)
      .required()
      .doc("mass flow: positive upward (discharge), negative downward (charge)");
  as_temperature(s.value("inlet-temperature", r.inlet_temperature))
      .positive()
      .doc("temperature of the inflow");
  as_temperature(s.value("stop-above", r.stop_above))
      .doc("the flow stops when the outlet is hotter than this");
  as_temperature(s.value("stop-below", r.stop_below))
      .doc("the flow stops when the outlet is colder than this");
  s.check(
      [&r] {
        return r.mass_flow == 0 || r.inlet_temperature > 0
                   ? ""
                   : "is missing; specify the temperature of this inflow";
      },
      "inlet-temperature");
}

void declare_schedule(config::Section& s, FlowParameters& p) {
  s.list<ScheduleRow>(
      "rows", p.rows, declare_row,
      "rows of the schedule; each applies until the next one, and the fluid is at rest before the first");
  s.value("file", p.file)
      .doc(
          "instead of rows: a CSV with the columns time [h], mass-flow [kg/s], inlet-temperature [degC] "
          "and, optionally, stop-above and stop-below, each with its unit; may be compressed (.gz)");
  s.optional_section<ScheduleRepeat>(
      "repeat", p.repeat,
      [](config::Section& q, ScheduleRepeat& r) {
        q.value("from", r.from)
            .unit("s", 1e-3, 1e11)
            .not_negative()
            .required()
            .doc("start of the periodic part, which contains the rows at or after this time");
        q.value("every", r.every)
            .unit("s", 1, 1e9)
            .positive()
            .required()
            .doc("period with which the periodic part repeats");
      },
      "the schedule repeats forever");
  s.check(
      [&p]() -> std::string {
        if (!p.file.empty())
          return p.rows.empty() ? "" : "are given together with a 'file' of rows; remove one of them";
        return problem_of_rows(p);
      },
      "rows");
}

struct FlowColumn {
  const char *name, *unit, *example;
  bool required;
};
constexpr std::array<FlowColumn, 5> known{{{"time", "s", "h", true},
                                           {"mass-flow", "kg/s", "kg/s", true},
                                           {"inlet-temperature", "K", "degC", true},
                                           {"stop-above", "K", "degC", false},
                                           {"stop-below", "K", "degC", false}}};

/// Columns of a file and their conversions to SI.
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

  /// Value [SI] of a column in a row; empty if missing.
  std::optional<double> value(const csv::CsvReader& row, std::size_t c) const {
    if (!at_[c] || row.cells()[*at_[c]].empty()) return {};
    return row.number(*at_[c], known[c].name) * unit_[c].factor + unit_[c].offset;
  }

 private:
  /// A heading without a unit would leave it open whether 290 is in K or degC.
  static base::Unit unit_of(const FlowColumn& column, const std::string& text, const std::string& place) {
    if (text.empty())
      throw Error("{}: the unit of the column '{}' is missing; write for example '{} [{}]'.", place,
                  column.name, column.name, column.example);
    try {
      return base::parse_unit(text, column.unit);
    } catch (const Error& error) {
      throw Error("{}: column '{}': {}", place, column.name, error.what());
    }
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

void declare(config::Section& section, FlowParameters& p) {
  using Type = FlowParameters::Type;
  section.variant<Type>("type", p.type,
                        {{"rest", Type::rest, [](config::Section&) {}},
                         {"schedule", Type::schedule, [&p](config::Section& s) { declare_schedule(s, p); }},
                         {"plant", Type::plant, [&p](config::Section& s) { declare(s, p.plant); }}},
                        "flow through the tank");
}

std::string problem_of_rows(const FlowParameters& p) {
  if (p.rows.empty()) return "at least one row is needed";
  for (std::size_t i = 1; i < p.rows.size(); ++i)
    if (p.rows[i].at <= p.rows[i - 1].at) return "each row must come after the one before it";
  if (p.repeat && p.rows.back().at < p.repeat->from) return "no rows are left to repeat";
  if (p.repeat && p.rows.back().at >= p.repeat->from + p.repeat->every)
    return "the last row is after the end of the repeated period";
  return "";
}

std::unique_ptr<FlowControl> make_flow_control(const FlowParameters& p, double specific_heat) {
  if (p.type == FlowParameters::Type::plant)
    return std::make_unique<PlantControl>(Plant(p.plant, specific_heat));
  return std::make_unique<FlowTable>(p);
}

FlowTable::ScheduledRow FlowTable::place_of(double t) const {
  const double now = t + 1e-6;
  auto begin = rows_.begin(), end = rows_.end();
  const auto repeated =
      repeat_ ? std::partition_point(begin, end, [&](const ScheduleRow& r) { return r.at < repeat_->from; })
              : end;
  const bool repeating = repeated != end && repeated->at <= now;
  double shift = 0;  // to this period
  if (repeating)
    begin = repeated, shift = std::floor((now - repeat_->from) / repeat_->every) * repeat_->every;
  else
    end = repeated;
  const auto next =
      std::partition_point(begin, end, [&](const ScheduleRow& r) { return r.at + shift <= now; });
  ScheduledRow place;
  if (next != begin)
    place.row = &*std::prev(next), place.began = place.row->at + shift;
  else if (repeating)  // the last row of the period before goes on
    place.row = &rows_.back(), place.began = place.row->at + shift - repeat_->every;
  if (next != end)
    place.next = next->at + shift;
  else if (repeated != rows_.end())
    place.next = repeated->at + (repeating ? shift + repeat_->every : 0);
  return place;
}

Flow FlowTable::decide(double t, double t_top, double t_bottom, const Ambient&) {
  const auto [row, began, next] = place_of(t);
  Flow flow;
  flow.until = next;
  if (began != memory.row_began) memory.row_began = began, memory.stopped = false;
  if (!row || row->mass_flow == 0) return flow;
  const double outlet = row->mass_flow > 0 ? t_top : t_bottom;
  if ((row->stop_above && outlet > *row->stop_above) || (row->stop_below && outlet < *row->stop_below))
    memory.stopped = true;
  if (memory.stopped) return flow;
  flow.mass_flow = row->mass_flow;
  flow.inlet_temperature = row->inlet_temperature;
  flow.mode = int(row - rows_.data()) + 1;
  return flow;
}

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

Flow PlantControl::decide(double t, double t_top, double t_bottom, const Ambient& ambient) {
  const PlantFlows flows =
      plant_.flows(plant_.field_heat(ambient.dni), t_top, t_bottom, memory.mode, plant_.load(t));
  memory.mode = flows.mode;
  Flow flow;
  flow.mode = static_cast<int>(flows.mode);
  flow.mass_flow = flows.tank_flow;
  flow.inlet_temperature =
      flows.mode == PlantMode::charge ? plant_.parameters().hot : plant_.parameters().cold;
  // Otherwise the bed at rest could take a long step past sunrise.
  constexpr double longest_without_a_look = 120;  // [s]
  flow.until = std::min(t + longest_without_a_look, plant_.load_until(t));
  return flow;
}

}  // namespace couplet::thermocline
