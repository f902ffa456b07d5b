// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "thermocline/base/celsius.hpp"
#include "thermocline/plant/plant_control.hpp"

namespace couplet::thermocline {

namespace {

void declare_row(config::Section& s, ScheduleRow& r) {
  s.value("at", r.at).unit("s").plausible(1e-3, 1e11).not_negative().required().doc("start time of the row");
  s.value("mass-flow", r.mass_flow)
      .unit("kg/s")
      .plausible(1e-6, 1e5)
      .required()
      .doc("upward (discharge) above 0, downward (charge) below 0");
  s.value("inlet-temperature", r.inlet_temperature)
      .unit("K")
      .plausible(70, 5000)
      .positive()
      .doc("temperature of the inflow");
  s.value("stop-above", r.stop_above)
      .unit("K")
      .plausible(70, 5000)
      .doc("the flow stops when the outlet is hotter");
  s.value("stop-below", r.stop_below)
      .unit("K")
      .plausible(70, 5000)
      .doc("the flow stops when the outlet is colder");
  s.check(
      [&r] {
        return r.mass_flow == 0 || r.inlet_temperature > 0
                   ? ""
                   : "is missing; specify the temperature of this inflow";
      },
      "inlet-temperature");
}

void declare_schedule(config::Section& s, FlowParameters& p) {
  s.list<ScheduleRow>("rows", p.rows, declare_row,
                      "each applies until the next one; at rest before the first");
  s.value("file", p.file)
      .doc(
          "instead of rows: a CSV with the columns time [h], mass-flow [kg/s], inlet-temperature [degC] "
          "and, optionally, stop-above and stop-below, each with its unit; may be compressed (.gz)");
  s.optional_section<ScheduleRepeat>(
      "repeat", p.repeat,
      [](config::Section& q, ScheduleRepeat& r) {
        q.value("from", r.from)
            .unit("s")
            .plausible(1e-3, 1e11)
            .not_negative()
            .required()
            .doc("rows at or after this time ...");
        q.value("every", r.every)
            .unit("s")
            .plausible(1, 1e9)
            .positive()
            .required()
            .doc("... repeat with this period");
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
  return std::make_unique<Schedule>(p);
}

Schedule::Place Schedule::place_of(double t) const {
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
  Place place;
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

Flow Schedule::decide(double t, double t_top, double t_bottom, const Ambient&) {
  const auto [row, began, next] = place_of(t);
  Flow flow;
  flow.until = next;
  const bool begins = began != current_;
  if (begins) current_ = began, stopped_ = false;
  if (!row || row->mass_flow == 0) return flow;
  const auto number = std::size_t(row - rows_.data());
  if (begins) began_[number] = true;
  const double outlet = row->mass_flow > 0 ? t_top : t_bottom;
  if ((row->stop_above && outlet > *row->stop_above) || (row->stop_below && outlet < *row->stop_below))
    stopped_ = true;
  if (stopped_) return flow;
  flow.mass_flow = row->mass_flow;
  flow.inlet_temperature = row->inlet_temperature;
  flow.mode = int(number) + 1;
  flowed_[number] = true;
  return flow;
}

std::vector<std::string> Schedule::doubts() const {
  std::vector<std::string> sentences;
  const auto flows = [](const ScheduleRow& row) { return row.mass_flow != 0; };
  const auto first = std::ranges::find_if(rows_, flows);
  if (first != rows_.end() && !(current_ >= first->at))
    sentences.push_back(fmt::format("no flow: the first row with a flow, flow.rows[{}], starts at {:g} s",
                                    first - rows_.begin(), first->at));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!began_[i] || flowed_[i]) continue;
    std::string limits;
    if (rows_[i].stop_above) limits += fmt::format(" above {:g} degC", celsius(*rows_[i].stop_above));
    if (rows_[i].stop_below)
      limits +=
          fmt::format("{} below {:g} degC", limits.empty() ? "" : " and", celsius(*rows_[i].stop_below));
    sentences.push_back(fmt::format(
        "flow.rows[{}] never ran: it stops{}, and the outlet (the {} of the tank) was beyond that whenever "
        "it started",
        i, limits, rows_[i].mass_flow > 0 ? "top" : "bottom"));
  }
  return sentences;
}

}  // namespace couplet::thermocline
