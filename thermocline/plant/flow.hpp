// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/saved_numbers.hpp"
#include "common/config/section.hpp"
#include "thermocline/base/interfaces.hpp"
#include "thermocline/plant/plant.hpp"

namespace couplet::thermocline {

/// A flow from a given time on, until the next row.
struct ScheduleRow {
  double at = 0;                                 ///< [s]
  double mass_flow = 0;                          ///< [kg/s], > 0 upward
  double inlet_temperature = 0;                  ///< [K]
  std::optional<double> stop_above, stop_below;  ///< the flow stops when the outlet passes this [K]
};
struct ScheduleRepeat {
  double from = 0, every = 0;  ///< rows at or after `from` come again every so many seconds [s]
};

struct FlowParameters {
  enum class Type { rest, schedule, plant } type = Type::rest;
  std::vector<ScheduleRow> rows;
  std::string file;  ///< of the rows, in their place
  std::optional<ScheduleRepeat> repeat;
  PlantParameters plant;
};
void declare(config::Section& section, FlowParameters& parameters);
/// What is wrong with the rows of a schedule; empty: nothing.
std::string problem_of_rows(const FlowParameters& parameters);
/// `specific_heat` of the fluid [J/(kg K)].
std::unique_ptr<FlowControl> make_flow_control(const FlowParameters& parameters, double specific_heat);

/// Flow by the clock. Labels: the number of the row (from 1) while it flows, 0 at rest.
class Schedule final : public FlowControl {
 public:
  explicit Schedule(const FlowParameters& parameters)
      : rows_(parameters.rows),
        repeat_(parameters.repeat),
        began_(rows_.size(), false),
        flowed_(rows_.size(), false) {}
  Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) override;
  std::vector<double> state() const override { return {current_, double(stopped_)}; }
  void restore(std::span<const double> state) override {
    base::SavedNumbers saved(state, "rows of the flow");
    current_ = saved.real(), stopped_ = saved.real() != 0;
  }
  /// Rows that were stopped each time before they began.
  std::vector<std::string> doubts() const override;

 private:
  /// The row in force, when it began, and when the next one does.
  struct Place {
    const ScheduleRow* row = nullptr;
    double began = -1, next = std::numeric_limits<double>::infinity();
  };
  Place place_of(double t) const;

  std::vector<ScheduleRow> rows_;
  std::optional<ScheduleRepeat> repeat_;
  double current_ = -1;  // when the row in force began
  bool stopped_ = false;
  std::vector<bool> began_, flowed_;  // each row, in this run
};

}  // namespace couplet::thermocline
