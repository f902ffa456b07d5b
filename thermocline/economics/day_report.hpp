// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "common/config/section.hpp"
#include "common/io/series.hpp"
#include "thermocline/base/clock.hpp"
#include "thermocline/base/interfaces.hpp"
#include "thermocline/economics/economics.hpp"
#include "thermocline/plant/plant.hpp"
#include "thermocline/wall/stress_history.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

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
class DayReport final : public TankObserver {
 public:
  /// `folder`: empty for none of the files. On restart the files go on from `restart_time`.
  DayReport(const ReportParameters& parameters, const Plant& plant, const Weather& weather,
            const std::filesystem::path& folder,
            double restart_time = std::numeric_limits<double>::quiet_NaN());

  void record(const TankRecord& record) override;
  void finish() override;
  std::vector<std::string> doubts() const override;
  std::vector<double> state() const override;
  void restore(std::span<const double> state) override;

  /// What the plant consists of, for its costs.
  void take_stock(const Inventory& inventory) { inventory_ = inventory; }

  const ReportSums& results() const { return results_; }
  int days_counted() const { return days_counted_; }
  const StressHistory& stress() const { return stress_; }
  std::vector<ReportLine> lines() const;

 private:
  double add_step(const BedStep& step);
  void add_thickness(const TankRecord& record);
  void end_day(double time);
  /// Whether this day, from 0, is behind the run-in.
  bool counts(int day) const;
  void write_profiles(const TankRecord& record);
  std::vector<ReportLine> lines_of(const ReportSums& sums, double days) const;
  void write_day(double time);
  void add_money(std::vector<ReportLine>& lines) const;
  bool whole_years() const;
  void write_series(const TankRecord& record, double moved, double field, double asked, double taken);

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
  std::unique_ptr<io::Series> days_, series_, profiles_;
};

}  // namespace couplet::thermocline
