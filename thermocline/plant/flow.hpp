// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/numbers.hpp"
#include "common/config/section.hpp"
#include "thermocline/plant/plant.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

/// Flow through the tank.
struct Flow {
  double mass_flow = 0;               ///< [kg/s]; > 0 upward: discharge, cold at the bottom; < 0: charge
  double inlet_temperature = 293.15;  ///< of what enters, at the bottom or at the top [K]
  int mode = 0;                       ///< a label of the control's own; comes back in BedStep
  /// The decision holds until this time at most [s]; the bed then asks again. It asks before each of its
  /// steps.
  double until = std::numeric_limits<double>::infinity();
};

/// Decides on the flow at the start of each step of the bed. A control with a memory (charging, waiting, ...)
/// hands it out and takes it back, so that a step of the simulation can be repeated.
class FlowControl {
 public:
  virtual ~FlowControl() = default;
  /// `t_top`, `t_bottom`: fluid temperature in the bed's top and bottom cell [K]; what flows out has it.
  virtual Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) = 0;
  virtual std::vector<double> state() const { return {}; }
  virtual void restore(std::span<const double>) {}
  /// At the end of a run: why what it did may not be what was meant. Sentences.
  virtual std::vector<std::string> doubts() const { return {}; }
};

/// One step of the bed, from t to t + dt.
struct BedStep {
  double t = 0, dt = 0;           ///< [s]
  Flow flow;                      ///< as decided at t
  Ambient ambient;                ///< at t
  double outlet_temperature = 0;  ///< mean of what left during the step [K]; the inlet's at rest
  double pressure_loss = 0;       ///< across the bed [Pa]; 0 where nobody asked for it
  double pump_power = 0;          ///< [W]
};

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
/// Returns why the rows of a schedule are not valid, or nothing.
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
    base::Numbers saved(state, "rows of the flow");
    saved(current_, stopped_);
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

/// Rows of a schedule from a CSV (may be compressed): '#' begins a comment, the first line names the columns with their
/// units, in any order: "time [h],mass-flow [kg/s],inlet-temperature [degC]" and, where wanted, "stop-above [degC]",
/// "stop-below [degC]", which may be empty in a row. A row holds until the next one. Throws Error with file:line.
std::vector<ScheduleRow> read_flow_file(const std::filesystem::path& file);

/// The plant decides what is pumped through the tank. Its memory is the process that runs.
class PlantControl final : public FlowControl {
 public:
  explicit PlantControl(const Plant& plant) : plant_(plant) {}

  Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) override;
  std::vector<double> state() const override { return {double(mode_)}; }
  void restore(std::span<const double> state) override {
    base::Numbers saved(state, "mode of the plant");
    unsigned mode = 0;
    saved(mode);
    if (mode > 2) saved.damaged();
    mode_ = PlantMode(mode);
  }

 private:
  Plant plant_;
  PlantMode mode_ = PlantMode::standby;
};

}  // namespace couplet::thermocline
