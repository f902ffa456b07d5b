// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "thermocline/plant/plant.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

/// Flow through the tank.
struct Flow {
  double mass_flow = 0;               ///< [kg/s]; > 0 upward (discharge, cold at the bottom); < 0 charge
  double inlet_temperature = 293.15;  ///< of the inflow, at the bottom or top [K]
  int mode = 0;                       ///< label of the control; returned in BedStep
  /// The bed asks for a decision before each of its steps, and at the latest at this time [s].
  double until = std::numeric_limits<double>::infinity();
};

/// State of a flow control: the row of the schedule in force, or the mode of the plant.
struct FlowMemory {
  double row_began = -1;  ///< [s]
  bool stopped = false;   ///< the row's flow has stopped at its limit
  PlantMode mode = PlantMode::standby;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(row_began, stopped, mode);
  }
};

/// Decides on the flow at the start of each bed step. Its memory can be restored, so that a simulation step
/// can be repeated.
class FlowControl {
 public:
  virtual ~FlowControl() = default;
  /// `t_top`, `t_bottom`: fluid temperature of the top and bottom cells [K], and so of the outflow.
  virtual Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) = 0;
  FlowMemory memory;
};

/// One step of the bed, from t to t + dt.
struct BedStep {
  double t = 0, dt = 0;           ///< [s]
  Flow flow;                      ///< as decided at t
  double outlet_temperature = 0;  ///< mean of the outflow during the step [K]; that of the inlet at rest
  double pressure_loss = 0;       ///< across the bed [Pa]; 0 if not requested
  double pump_power = 0;          ///< [W]
};

/// A flow from a given time on, until the next row.
struct ScheduleRow {
  double at = 0;                                 ///< [s]
  double mass_flow = 0;                          ///< [kg/s], > 0 upward
  double inlet_temperature = 0;                  ///< [K]
  std::optional<double> stop_above, stop_below;  ///< limits of the outlet temperature [K]
};
struct ScheduleRepeat {
  double from = 0, every = 0;  ///< rows at or after `from` repeat with this period [s]
};

struct FlowParameters {
  enum class Type { rest, schedule, plant } type = Type::rest;
  std::vector<ScheduleRow> rows;
  std::string file;  ///< file of the rows, instead of `rows`
  std::optional<ScheduleRepeat> repeat;
  PlantParameters plant;
};
void declare(config::Section& section, FlowParameters& parameters);
/// Returns why the rows of a schedule are invalid, or nothing.
std::string problem_of_rows(const FlowParameters& parameters);
/// `specific_heat`: specific heat of the fluid [J/(kg K)].
std::unique_ptr<FlowControl> make_flow_control(const FlowParameters& parameters, double specific_heat);

/// Flow from a schedule. Labels: number of the row (from 1) while it flows, 0 at rest.
class FlowTable final : public FlowControl {
 public:
  explicit FlowTable(const FlowParameters& parameters) : rows_(parameters.rows), repeat_(parameters.repeat) {}
  Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) override;

 private:
  /// Current row, its start, and the start of the next one.
  struct ScheduledRow {
    const ScheduleRow* row = nullptr;
    double began = -1, next = std::numeric_limits<double>::infinity();
  };
  ScheduledRow place_of(double t) const;

  std::vector<ScheduleRow> rows_;
  std::optional<ScheduleRepeat> repeat_;
};

/// Reads schedule rows from a CSV file, optionally compressed. '#' starts a comment. The first line names the
/// columns with units in any order: "time [h],mass-flow [kg/s],inlet-temperature [degC]", optionally
/// "stop-above [degC]", "stop-below [degC]" with empty entries. Throws Error.
std::vector<ScheduleRow> read_flow_file(const std::filesystem::path& file);

/// Flow control by the plant.
class PlantControl final : public FlowControl {
 public:
  explicit PlantControl(const Plant& plant) : plant_(plant) {}
  Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) override;

 private:
  Plant plant_;
};

}  // namespace couplet::thermocline
