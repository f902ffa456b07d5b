// SPDX-License-Identifier: Apache-2.0
// The files of the day report.
#include <cmath>
#include <fstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "thermocline/base/celsius.hpp"
#include "thermocline/base/clock.hpp"
#include "thermocline/economics/day_report.hpp"

namespace couplet::thermocline {

namespace {

using Sums = ReportSums;

}  // namespace

DayReport::DayReport(const ReportParameters& parameters, const Plant& plant, const Weather& weather,
                     const std::filesystem::path& folder, double restart_time)
    : p_(parameters), plant_(plant), weather_(weather), folder_(folder) {
  if (folder_.empty()) return;
  std::vector<std::string> columns{"time [s]"};
  for (const ReportLine& line : lines_of({}, 1))
    columns.push_back(fmt::format("{} [{}]", line.quantity, line.unit));
  days_ = std::make_unique<io::Series>(folder_ / "days.csv", columns, restart_time);
  series_ = std::make_unique<io::Series>(
      folder_ / "plant.csv",
      std::vector<std::string>{"time [s]", "solar field [W]", "power block [W]", "demand [W]",
                               "tank flow [kg/s]", "top [degC]", "bottom [degC]", "thermocline thickness [m]",
                               "losses [W]", "irradiance [W/m^2]", "air [degC]", "wind [m/s]"},
      restart_time);
  if (p_.profile_day)
    profiles_ = std::make_unique<io::Series>(
        folder_ / "profiles.csv",
        std::vector<std::string>{"time [s]", "z [m]", "fluid [degC]", "filler [degC]", "wall [degC]",
                                 "share of yield strength [-]"},
        restart_time);
}

void DayReport::write_profiles(const TankRecord& record) {
  const double begin = *p_.profile_day * seconds_a_day;
  const double before = std::floor((record.time - record.dt - begin) / seconds_an_hour + clock_rounding);
  const double now = std::floor((record.time - begin) / seconds_an_hour + clock_rounding);
  if (now == before || now < 0 || now > 24) return;
  for (std::size_t i = 0; i < record.z.size(); ++i) {
    const bool wall = i < record.wall_z.size();
    const double none = std::numeric_limits<double>::quiet_NaN();
    profiles_->row(std::array{record.time, record.z[i], celsius(record.fluid_temperature[i]),
                              celsius(record.filler_temperature[i]),
                              wall ? celsius(record.wall_temperature[i]) : none,
                              wall ? record.equivalent_stress[i] / record.yield_strength[i] : none});
  }
}

/// A row of plant.csv; `field`, `asked`, `taken`: heat over the step [J].
void DayReport::write_series(const TankRecord& record, double moved, double field, double asked,
                             double taken) {
  const Ambient air = weather_.at(record.time);
  const double dni = weather_.irradiation(record.time - record.dt, record.time) / record.dt;
  series_->row(std::array{record.time, field / record.dt, taken / record.dt, asked / record.dt,
                          moved / record.dt, celsius(record.fluid_temperature.back()),
                          celsius(record.fluid_temperature.front()), last_thickness_,
                          record.losses() / record.dt, dni, celsius(air.temperature), air.wind});
}

void DayReport::write_day(double time) {
  if (!days_) return;
  std::vector<double> row{time};
  for (const ReportLine& line : lines_of(day_, day_[Sums::duration] / seconds_a_day))
    row.push_back(line.value);
  days_->row(row);
}

void DayReport::finish() {
  if (days_counted_ == 0) {
    stress_.end_day(true);
    results_.add(day_);
  }
  if (folder_.empty()) return;
  std::ofstream summary(base::own_file(folder_ / "summary.csv"));
  summary << "quantity,unit,value\n";
  for (const ReportLine& line : lines())
    summary << fmt::format("{},{},{}\n", line.quantity, line.unit, line.value);
  if (!stress_.empty()) {
    std::ofstream stress(base::own_file(folder_ / "stress.csv"));
    stress << "z [m],mean daily lowest share [-],mean daily highest share [-],highest share [-]\n";
    const std::vector<double> low = stress_.mean_lowest(), high = stress_.mean_highest();
    for (std::size_t i = 0; i < low.size(); ++i)
      stress << fmt::format("{},{},{},{}\n", stress_.z()[i], low[i], high[i], stress_.highest()[i]);
    stress.flush();
    if (!stress) throw Error("Cannot write {}. Is the disk full?", (folder_ / "stress.csv").string());
  }
  summary.flush();
  if (!summary) throw Error("Cannot write {}. Is the disk full?", (folder_ / "summary.csv").string());
}

}  // namespace couplet::thermocline
