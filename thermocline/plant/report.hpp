// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/io/series.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/plant/flow.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

/// Column of an output file: its heading with the unit, and its value for a row's view.
template <class View>
struct OutputColumn {
  const char* heading;
  double (*value)(const View&);
};

/// CSV file with one quantity per column. A restarted run continues it from `restart_time`.
template <class View>
class QuantityFile {
 public:
  QuantityFile(const std::filesystem::path& file, const std::vector<OutputColumn<View>>& quantities,
               double restart_time)
      : quantities_(quantities), series_(file, headings(quantities), restart_time) {}
  void row(const View& view) {
    row_.clear();
    for (const OutputColumn<View>& quantity : quantities_) row_.push_back(quantity.value(view));
    series_.row(row_);
  }

 private:
  static std::vector<std::string> headings(const std::vector<OutputColumn<View>>& quantities) {
    std::vector<std::string> all;
    for (const OutputColumn<View>& quantity : quantities) all.emplace_back(quantity.heading);
    return all;
  }
  std::vector<OutputColumn<View>> quantities_;
  io::Series series_;
  std::vector<double> row_;
};

/// One accepted simulation step: the bed steps in it and the state at its end. Profiles are views into the
/// tank, bottom to top, valid during the call; those not requested are empty.
struct TankRecord {
  double time = 0;  ///< end of the step [s]
  double dt = 0;    ///< [s]
  std::span<const BedStep> steps;
  // The bed, one value per cell.
  std::span<const double> z, dz;              ///< centers and heights [m]
  std::span<const double> fluid_temperature;  ///< [K]
  std::vector<double> filler_temperature;     ///< mean of the particles [K]
  // The shell, one value per ring (more than bed cells if the wall continues around the ullage).
  std::span<const double> wall_z;             ///< centers [m]
  std::span<const double> wall_temperature;   ///< [K]
  std::span<const double> equivalent_stress;  ///< von Mises [Pa]
  std::span<const double> yield_strength;     ///< at the ring's temperature [Pa]
  // Heat over the step [J].
  double stored = 0;  ///< gained by fluid and filler (5.25-5.27)
  double losses = 0;  ///< to the air, the sky and the deep soil
  /// Heat that warms fluid and filler from cold to hot (Q_storable of 5.28), per kelvin [J/K].
  double heat_capacity = 0;
};

/// Stress of each ring relative to its yield strength: daily extreme values, their sums, and the largest of
/// all. Memory is independent of the length of the run.
///
/// The factors of safety compare stress and strength at the same time, because the strength decreases with
/// temperature. With s = sigma_eq/sigma_y(T), FoS_static = 1/max s (5.21). With the means of the daily
/// extremes, FoS_dynamic = (1 - s_min)/(s_max - s_min) (5.22 divided by the strength).
class StressHistory {
 public:
  struct Ring {
    double z = 0;                                   ///< center [m]
    double day_lowest = 0, day_highest = 0;         ///< of the day so far
    double sum_lowest = 0, sum_highest = 0;         ///< of the counted days
    double highest = 0;                             ///< of all counted days
    double day_highest_time = 0, highest_time = 0;  ///< [s]
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(z, day_lowest, day_highest, sum_lowest, sum_highest, highest, day_highest_time, highest_time);
    }
  };
  void see(double time, std::span<const double> z, std::span<const double> equivalent,
           std::span<const double> yield);
  /// `counts`: the day is included in the results.
  void end_day(bool counts);

  struct Factor {
    double value = 0;
    double z = 0;     ///< center of the ring [m]
    double time = 0;  ///< [s]; of the static factor only
  };
  bool empty() const { return days_ == 0 || rings_.empty(); }
  Factor static_factor() const;
  Factor dynamic_factor() const;
  int days() const { return days_; }  ///< number of counted days
  const std::vector<Ring>& rings() const { return rings_; }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(rings_, days_, day_begun_);
  }

 private:
  std::vector<Ring> rings_;
  bool day_begun_ = false;
  int days_ = 0;
};

/// Prices in any currency.
struct EconomicsParameters {
  double field = 0;                         ///< per square meter of solar field [1/m^2]
  double block = 0;                         ///< per kilowatt of the power block's electric output [1/kW]
  double fixed = 0;                         ///< independent of the size of the plant
  double steel = 0, filler = 0, fluid = 0;  ///< [1/kg]
  double pump = 0;                          ///< per kilowatt of the pump's or fan's largest power [1/kW]
  double insulation = 0, foundation = 0;    ///< per square meter of wall and roof, of ground [1/m^2]
  double operation = 0.02;                  ///< per year, share of the capital
  double interest = 0.07;                   ///< per year
  double lifetime = 25;                     ///< [years]
};
void declare(config::Section& section, EconomicsParameters& parameters);

/// Parts of tank and plant with a price.
struct Inventory {
  double field_area = 0, block_power = 0;   ///< [m^2], electric [W]
  double steel = 0, filler = 0, fluid = 0;  ///< filler: grains and capsules [kg]
  double insulated = 0, foundation = 0;     ///< [m^2]
  double pump_power = 0;                    ///< largest of the run [W]
};

struct LevelisedCost {
  double capital = 0, storage = 0;  ///< total; tank with its contents and its pump
  double annuity = 0;               ///< share of the capital to repay each year
  double per_year = 0;              ///< annuity and operation
  double per_energy = 0;            ///< [1/MWh]; infinite without electricity
};

/// (a + o) C/E with the annuity a = i (1 + i)^n/((1 + i)^n - 1), or 1/n without interest. C is the capital, o
/// the operation, E the annual electricity [MWh].
LevelisedCost levelised_cost(const EconomicsParameters& prices, const Inventory& inventory,
                             double electricity);

inline constexpr double megawatt_hour = 3.6e9;  // [J]

struct ReportParameters {
  double run_in = 0;  ///< days before the first counted day
  /// Margins of the critical temperatures of the thermocline's thickness (5.30) [K].
  double thickness_margin = 15;
  std::optional<double> profile_day;  ///< days from the start; its profiles are written hourly
  std::optional<EconomicsParameters> economics;
};
void declare(config::Section& section, ReportParameters& parameters);

/// Sums over one or more days: energies [J], times [s].
struct ReportSums {
  enum Item : std::size_t {
    field,
    excess,
    stored,
    delivered,
    exergy,
    lacking,
    losses,
    charging,
    discharging,
    charged_rest,
    discharged_rest,
    cold_outlet,
    hot_outlet,
    thickness,  ///< integral of h_th over the time in which it is defined [m s]
    thickness_time,
    duration,
    asked,        ///< heat requested by the power block
    taken,        ///< heat received by the power block
    electricity,  ///< net: from the received heat, less pump or fan work
    revenue,      ///< of the net electricity [currency]
    pumping,      ///< work of pump or fan
    n_items
  };
  std::array<double, n_items> sum{};
  double operator[](Item item) const { return sum[item]; }
  double& operator[](Item item) { return sum[item]; }
  void add(const ReportSums& other);
};

/// Row of tables 5.5 and 5.6 of [thesis].
struct ReportLine {
  std::string quantity, unit;
  double value;
  const char* meaning = "";  ///< shown at the end of a run; empty for the rest
};

constexpr const char* unmet_demand =
    ", demand not met";  ///< meaning of the line of the power block's missing heat

/// Daily accounting of tank and plant. Writes
///   - days.csv: one line per day, all rows of tables 5.5 and 5.6 for that day;
///   - summary.csv: means over the days after the run-in, both factors of safety with place and time;
///   - plant.csv: a time series, one line per simulation step;
///   - profiles.csv: temperatures and stress over height, hourly on the profile day, if there is one;
///   - stress.csv: per ring, means of the daily extremes and the largest share of the yield strength.
class DayReport final {
 public:
  /// `folder`: empty to write no files. A restarted run continues the files from `restart_time`.
  DayReport(const ReportParameters& parameters, const Plant& plant, const Weather& weather,
            const std::filesystem::path& folder,
            double restart_time = std::numeric_limits<double>::quiet_NaN());

  /// Adds an accepted step.
  void record(const TankRecord& record);
  /// Writes the summary at the end of the run.
  void finish();
  /// Reasons to doubt the results written by finish(), as sentences.
  std::vector<std::string> doubts() const;
  /// Data for checkpoints. Throws Error if the continued run counted other days.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(days_seen_, days_counted_, storable_, bed_height_, last_thickness_, last_time_, largest_pump_,
            day_.sum, results_.sum, stress_);
    if (numbers.reads()) refuse_other_run_in();
  }

  /// Sets the parts of tank and plant with a price.
  void take_stock(const Inventory& inventory) { inventory_ = inventory; }

  const ReportSums& results() const { return results_; }
  int days_counted() const { return days_counted_; }
  const StressHistory& stress() const { return stress_; }
  std::vector<ReportLine> lines() const;

 private:
  void refuse_other_run_in() const;
  double add_step(const BedStep& step);
  void add_thickness(const TankRecord& record);
  void end_day(double time);
  /// Returns true if this day, from 0, is after the run-in.
  bool counts(int day) const;
  /// Step in plant.csv: means over it and states at its end.
  struct StepRow {
    const TankRecord& record;
    Ambient air;
    double dni, moved, field, asked, taken;  ///< [W/m^2]; flow [kg] and heat [J] of the step
    double thickness;                        ///< of the thermocline [m]
  };
  /// Cell of the bed and its ring at the end of a step.
  struct BedCell {
    const TankRecord& record;
    std::size_t i;
    bool has_ring() const { return i < record.wall_z.size(); }
  };
  void write_profiles(const TankRecord& record);
  std::vector<ReportLine> lines_of(const ReportSums& sums, double days) const;
  void write_day(double time);
  void add_money(std::vector<ReportLine>& lines) const;
  bool whole_years() const;

  ReportParameters p_;
  Plant plant_;
  const Weather& weather_;
  std::filesystem::path folder_;
  ReportSums day_, results_;
  StressHistory stress_;
  Inventory inventory_;
  int days_seen_ = 0, days_counted_ = 0;
  double storable_ = 0, bed_height_ = 0, last_thickness_ = 0, last_time_ = 0;
  double largest_pump_ = 0;  // of the run [W]
  std::unique_ptr<io::Series> days_;
  std::optional<QuantityFile<StepRow>> series_;
  std::optional<QuantityFile<BedCell>> profiles_;
};

/// Thickness of the thermocline [m], equation 5.30 of [thesis]: the height between the critical temperatures
/// `cold` and `hot`. If one has left the bed, it is extrapolated with the mean gradient of the remaining part
/// (if both have, of the whole bed). `z`: cell centers, upward. `height`: height of the bed [m].
/// `temperature`: temperature of each cell, all in the same unit. Empty if the whole bed is hot or cold.
std::optional<double> thermocline_thickness(std::span<const double> z, double height,
                                            std::span<const double> temperature, double cold, double hot);

}  // namespace couplet::thermocline
