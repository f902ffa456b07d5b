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

/// A column of an output file: its heading with the unit, and its value in the view of a row.
template <class View>
struct Quantity {
  const char* heading;
  double (*value)(const View&);
};

/// A CSV file with a quantity per column. On restart it goes on from `restart_time`.
template <class View>
class QuantityFile {
 public:
  QuantityFile(const std::filesystem::path& file, const std::vector<Quantity<View>>& quantities,
               double restart_time)
      : quantities_(quantities), series_(file, headings(quantities), restart_time) {}
  void row(const View& view) {
    row_.clear();
    for (const Quantity<View>& quantity : quantities_) row_.push_back(quantity.value(view));
    series_.row(row_);
  }

 private:
  static std::vector<std::string> headings(const std::vector<Quantity<View>>& quantities) {
    std::vector<std::string> all;
    for (const Quantity<View>& quantity : quantities) all.emplace_back(quantity.heading);
    return all;
  }
  std::vector<Quantity<View>> quantities_;
  io::Series series_;
  std::vector<double> row_;
};

/// One accepted step of the simulation: the steps of the bed in it, and where things stand at its end.
/// Profiles are views into the tank, bottom to top, valid during the call; what was not asked for is empty.
struct TankRecord {
  double time = 0;  ///< end of the step [s]
  double dt = 0;    ///< [s]
  std::span<const BedStep> steps;
  // The bed, one value a cell.
  std::span<const double> z, dz;              ///< centers and heights [m]
  std::span<const double> fluid_temperature;  ///< [K]
  std::vector<double> filler_temperature;     ///< mean of the particles [K]
  // The shell, one value a ring (more than cells of the bed if the wall goes on around the ullage).
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

/// Which share of its yield strength each ring of the wall carried: daily extremes, their sums, the largest
/// of all. As many numbers as rings, however long the run.
///
/// The factors of safety compare stress and strength at the same moment, because the strength falls with
/// temperature: with s = sigma_eq / sigma_y(T), FoS_static = 1 / max s (5.21) and, with the means of the
/// daily extremes, FoS_dynamic = (1 - s_min) / (s_max - s_min) (5.22 divided by the strength).
class StressHistory {
 public:
  struct Ring {
    double z = 0;                                   ///< center [m]
    double day_lowest = 0, day_highest = 0;         ///< of the day so far
    double sum_lowest = 0, sum_highest = 0;         ///< of the days that count
    double highest = 0;                             ///< of all days that count
    double day_highest_time = 0, highest_time = 0;  ///< [s]
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(z, day_lowest, day_highest, sum_lowest, sum_highest, highest, day_highest_time, highest_time);
    }
  };
  void see(double time, std::span<const double> z, std::span<const double> equivalent,
           std::span<const double> yield);
  /// `counts`: the day belongs to the results; otherwise it is looked at but not kept.
  void end_day(bool counts);

  struct Factor {
    double value = 0;
    double z = 0;     ///< center of the ring [m]
    double time = 0;  ///< [s]; of the static factor only
  };
  bool empty() const { return days_ == 0 || rings_.empty(); }
  Factor static_factor() const;
  Factor dynamic_factor() const;
  int days() const { return days_; }  ///< that count
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

/// Prices, in a currency of one's own.
struct EconomicsParameters {
  double field = 0;                         ///< of a square metre of solar field [1/m^2]
  double block = 0;                         ///< of a kilowatt of the power block's electric output [1/kW]
  double fixed = 0;                         ///< whatever does not grow with the plant
  double steel = 0, filler = 0, fluid = 0;  ///< [1/kg]
  std::optional<double> capsules;           ///< of the layers that melt; absent: as filler [1/kg]
  double pump = 0;                          ///< of a kilowatt of the pump's or fan's largest power [1/kW]
  double insulation = 0, foundation = 0;    ///< of a square metre of wall and roof, of ground [1/m^2]
  double operation = 0.02;                  ///< a year, share of the capital
  double interest = 0.07;                   ///< a year
  double lifetime = 25;                     ///< [years]
};
void declare(config::Section& section, EconomicsParameters& parameters);

/// Parts of tank and plant that cost something.
struct Inventory {
  double field_area = 0, block_power = 0;   ///< [m^2], electric [W]
  double steel = 0, filler = 0, fluid = 0;  ///< [kg]
  double insulated = 0, foundation = 0;     ///< [m^2]
  double capsules = 0;                      ///< not in filler [kg]
  double pump_power = 0;                    ///< largest of the run [W]
};

struct LevelisedCost {
  double capital = 0, storage = 0;  ///< all, and the tank with its contents and its pump
  double annuity = 0;               ///< share of the capital to pay back each year
  double per_year = 0;              ///< annuity and operation
  double per_energy = 0;            ///< [1/MWh]; infinite without electricity
};

/// (a + o) C / E with the annuity a = i (1 + i)^n/((1 + i)^n - 1), 1/n without interest; C the capital, o the
/// operation, E the electricity of a year [MWh].
LevelisedCost levelised_cost(const EconomicsParameters& prices, const Inventory& inventory,
                             double electricity);

inline constexpr double megawatt_hour = 3.6e9;  // [J]

struct ReportParameters {
  double run_in = 0;  ///< days before the first that counts
  /// Margins of the critical temperatures of the thermocline's thickness (5.30) [K].
  double thickness_margin = 15;
  double outlet_margin = 5;           ///< "near the design temperature" of the outlets [K]
  std::optional<double> profile_day;  ///< days from the start; its profiles are written every hour
  double dead_state = 318.15;         ///< T_ref of the exergy (5.29) [K]
  std::optional<EconomicsParameters> economics;
};
void declare(config::Section& section, ReportParameters& parameters);

/// Sums of a day or of many: energies [J], times [s].
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
    thickness,  ///< integral of h_th over the time for which it is defined [m s]
    thickness_time,
    duration,
    asked,        ///< heat that the power block asked for
    taken,        ///< and got
    electricity,  ///< net: of the heat it got, less what pump or fan took
    revenue,      ///< of the net electricity [currency]
    pumping,      ///< work of pump or fan
    n_items
  };
  std::array<double, n_items> sum{};
  double operator[](Item item) const { return sum[item]; }
  double& operator[](Item item) { return sum[item]; }
  void add(const ReportSums& other);
};

/// One line of tables 5.5 and 5.6 of [thesis].
struct ReportLine {
  std::string quantity, unit;
  double value;
};

/// Keeps the books of tank and plant day by day, and writes
///  - days.csv: one line a day, all rows of tables 5.5 and 5.6 for that day alone;
///  - summary.csv: their means over the days after the run-in, both factors of safety with place and time;
///  - plant.csv: a time series, one line a step of the simulation;
///  - profiles.csv: temperatures and stress over height, every hour of the profile day, if there is one;
///  - stress.csv: ring by ring, means of the daily extremes and the largest share of the yield strength.
class DayReport final {
 public:
  /// `folder`: empty for none of the files. On restart the files go on from `restart_time`.
  DayReport(const ReportParameters& parameters, const Plant& plant, const Weather& weather,
            const std::filesystem::path& folder,
            double restart_time = std::numeric_limits<double>::quiet_NaN());

  /// Adds an accepted step.
  void record(const TankRecord& record);
  /// Writes the summary at the end of the run.
  void finish();
  /// After finish(): why what it wrote may not be what was meant. Sentences.
  std::vector<std::string> doubts() const;
  /// For checkpoints. Throws Error if the run to be continued counted other days.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(days_seen_, days_counted_, storable_, bed_height_, last_thickness_, last_time_, largest_pump_,
            day_.sum, results_.sum, stress_);
    if (numbers.reads()) refuse_other_run_in();
  }

  /// Sets the parts of tank and plant, for their costs.
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
  /// A step as plant.csv shows it: means over it and states at its end.
  struct StepRow {
    const TankRecord& record;
    Ambient air;
    double dni, moved, field, asked, taken;  ///< [W/m^2]; of the flow [kg], heat of the step [J]
    double thickness;                        ///< of the thermocline [m]
  };
  /// A cell of the bed and the ring beside it, at the end of a step.
  struct Place {
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
  std::optional<QuantityFile<Place>> profiles_;
};

/// Thickness of the thermocline [m], equation 5.30 of [thesis]: the height between the critical temperatures
/// `cold` and `hot`; where one of them has left the bed, extrapolated with the mean gradient of the part that
/// is still there (both: with that of the whole bed). `z` centers of the cells, upward, `height` of the bed
/// [m], `temperature` a value a cell, `bottom` and `top` the temperatures there, all in the same unit.
/// Nothing if the bed is hot or cold all through.
std::optional<double> thermocline_thickness(std::span<const double> z, double height,
                                            std::span<const double> temperature, double cold, double hot);

}  // namespace couplet::thermocline
