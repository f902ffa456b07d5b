// SPDX-License-Identifier: Apache-2.0
#include "thermocline/day_report.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "thermocline/celsius.hpp"
#include "thermocline/thickness.hpp"

namespace couplet::thermocline {
namespace {

constexpr double day_length = 86400, hour = 3600;  // [s]
constexpr double megawatt_hour = 3.6e9;            // [J]
using Sums = ReportSums;

double share(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

}  // namespace

void declare(config::Section& s, ReportParameters& p) {
  s.value("run-in", p.run_in)
      .unit("day")
      .not_negative()
      .doc("the means leave out these days at the start, in which the cycle becomes periodic");
  s.value("profile-day", p.profile_day)
      .unit("day")
      .not_negative()
      .doc("so many days after the start the profiles of one day are written, every hour; absent: none");
  s.value("thickness-margin", p.thickness_margin)
      .unit("K")
      .positive()
      .doc("the thermocline lies between the cold temperature plus and the hot temperature minus this");
  s.value("outlet-margin", p.outlet_margin)
      .unit("K")
      .positive()
      .doc("the time is counted in which the tank's outlet is nearer than this to its design temperature");
  s.optional_section<EconomicsParameters>(
      "economics", p.economics, [](config::Section& q, EconomicsParameters& e) { declare(q, e); },
      "prices, in a currency of one's own: the summary then has capital and levelised cost of the "
      "electricity");
  s.value("dead-state", p.dead_state).unit("K").positive().doc("reference temperature of the exergy");
}

void ReportSums::add(const ReportSums& other) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += other.sum[i];
}

DayReport::DayReport(const ReportParameters& parameters, const Plant& plant, const Weather& weather,
                     const std::filesystem::path& folder, double restart_time)
    : p_(parameters), plant_(plant), weather_(weather), folder_(folder) {
  if (folder_.empty()) return;
  std::vector<std::string> columns{"time [s]"};
  for (const ReportLine& line : lines_of({}, 1))
    columns.push_back(fmt::format("{} [{}]", line.quantity, line.unit));
  days_ = std::make_unique<Series>(folder_ / "days.csv", columns, restart_time);
  series_ = std::make_unique<Series>(
      folder_ / "plant.csv",
      std::vector<std::string>{"time [s]", "solar field [W]", "power block [W]", "tank flow [kg/s]",
                               "top [degC]", "bottom [degC]", "thermocline thickness [m]", "losses [W]"},
      restart_time);
  if (p_.profile_day)
    profiles_ = std::make_unique<Series>(
        folder_ / "profiles.csv",
        std::vector<std::string>{"time [s]", "z [m]", "fluid [degC]", "filler [degC]", "wall [degC]",
                                 "share of yield strength [-]"},
        restart_time);
}

void DayReport::write_profiles(const TankRecord& record) {
  const double begin = *p_.profile_day * day_length;
  const double before = std::floor((record.time - record.dt - begin) / hour + 1e-9);
  const double now = std::floor((record.time - begin) / hour + 1e-9);
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

/// Books one step of the bed; gives the heat that the flow brought into it [J].
double DayReport::add_step(const BedStep& step) {
  const PlantParameters& plant = plant_.parameters();
  const double dt = step.dt, c = plant_.specific_heat();
  const double field = plant_.field_heat(weather_.irradiation(step.t, step.t + dt)),
               block = plant_.block_heat() * plant_.load(step.t) * dt;
  const double outlet = step.outlet_temperature, mass = std::abs(step.flow.mass_flow) * dt;
  day_[Sums::field] += field;
  day_[Sums::excess] += std::max(field - block, 0.);  // (5.24)
  day_[Sums::lacking] += std::max(block - field, 0.);
  day_[Sums::duration] += dt;
  day_[Sums::asked] += block;
  day_[Sums::pumping] += step.pump_power * dt;
  const auto sell = [&](double heat) {
    day_[Sums::electricity] += plant.block_efficiency * heat;
    day_[Sums::revenue] += plant_.tariff(step.t) * plant.block_efficiency * heat / megawatt_hour;
  };
  sell(std::min(field, block));
  const auto mode = static_cast<PlantMode>(step.flow.mode);
  if (mode == PlantMode::standby) {
    day_[field > block ? Sums::charged_rest : Sums::discharged_rest] += dt;
    return 0;
  }
  const double inlet = step.flow.inlet_temperature;
  if (mode == PlantMode::charge) {
    day_[Sums::charging] += dt;
    if (outlet < plant.cold + p_.outlet_margin) day_[Sums::cold_outlet] += dt;
    return mass * c * (inlet - outlet);
  }
  const double delivered = mass * c * (outlet - plant.cold);
  day_[Sums::discharging] += dt;
  if (outlet > plant.hot - p_.outlet_margin) day_[Sums::hot_outlet] += dt;
  day_[Sums::delivered] += delivered;
  sell(delivered);
  day_[Sums::lacking] -= delivered;
  // (5.29)
  day_[Sums::exergy] += delivered - mass * c * p_.dead_state * std::log(outlet / plant.cold);
  return mass * c * (inlet - outlet);
}

void DayReport::add_thickness(const TankRecord& record) {
  const PlantParameters& plant = plant_.parameters();
  const auto thickness =
      thermocline_thickness(record.z, bed_height_, record.fluid_temperature, plant.cold + p_.thickness_margin,
                            plant.hot - p_.thickness_margin);
  last_thickness_ = thickness.value_or(std::numeric_limits<double>::quiet_NaN());
  if (!thickness) return;
  day_[Sums::thickness] += *thickness * record.dt;
  day_[Sums::thickness_time] += record.dt;
}

void DayReport::record(const TankRecord& record) {
  if (bed_height_ == 0) {
    for (const double dz : record.dz) bed_height_ += dz;
    storable_ = record.heat_capacity * (plant_.parameters().hot - plant_.parameters().cold);
  }
  double brought = 0, charged = 0, charging_time = 0, moved = 0;
  for (const BedStep& step : record.steps) {
    const double heat = add_step(step);
    brought += heat;
    moved += step.flow.mass_flow * step.dt;
    if (static_cast<PlantMode>(step.flow.mode) != PlantMode::charge) continue;
    charged += heat;
    charging_time += step.dt;
  }
  // What the flow brought less what the bed gained went through the walls, evenly over the step (5.25-5.27).
  day_[Sums::stored] += charged - (brought - record.stored) * charging_time / record.dt;
  day_[Sums::losses] += record.losses();
  add_thickness(record);
  if (!record.equivalent_stress.empty())
    stress_.see(record.time, record.wall_z, record.equivalent_stress, record.yield_strength);
  if (series_) {
    const double field =
        plant_.field_heat(weather_.irradiation(record.time - record.dt, record.time)) / record.dt;
    series_->row(std::array{
        record.time, field, plant_.block_heat(), moved / record.dt, celsius(record.fluid_temperature.back()),
        celsius(record.fluid_temperature.front()), last_thickness_, record.losses() / record.dt});
  }
  if (profiles_) write_profiles(record);
  // A hair's breadth before midnight is midnight.
  if (record.time >= (days_seen_ + 1) * day_length - 1e-3) end_day(record.time);
}

void DayReport::end_day(double time) {
  const bool counts = days_seen_ * day_length >= p_.run_in * day_length - 1;
  ++days_seen_;
  stress_.end_day(counts);
  write_day(time);
  if (counts) {
    ++days_counted_;
    results_.add(day_);
  }
  day_ = {};
}

std::vector<ReportLine> DayReport::lines_of(const ReportSums& s, double days) const {
  const auto energy = [&](Sums::Item item) { return days > 0 ? s[item] / days / megawatt_hour : 0; };
  const auto time = [&](Sums::Item item) { return days > 0 ? s[item] / days / hour : 0; };
  const double thickness = s[Sums::thickness_time] > 0 ? s[Sums::thickness] / s[Sums::thickness_time] : 0;
  return {{"Q_SF", "MWh/day", energy(Sums::field)},
          {"Q_excess/Q_SF", "%", share(s[Sums::excess], s[Sums::field])},
          {"Q_C/Q_excess", "%", share(s[Sums::stored], s[Sums::excess])},
          {"Q_D/Q_C", "%", share(s[Sums::delivered], s[Sums::stored])},
          {"B_D", "MWh/day", energy(Sums::exergy)},
          {"Q_lacking/Q_PB", "%", share(s[Sums::lacking], s[Sums::asked])},
          {"energy losses", "MWh/day", energy(Sums::losses)},
          {"charge time", "h", time(Sums::charging)},
          {"discharge time", "h", time(Sums::discharging)},
          {"charged stand-by time", "h", time(Sums::charged_rest)},
          {"discharged stand-by time", "h", time(Sums::discharged_rest)},
          {"time with cold outlet", "%", share(s[Sums::cold_outlet], s[Sums::charging])},
          {"time with hot outlet", "%", share(s[Sums::hot_outlet], s[Sums::discharging])},
          {"eta_th", "%", share(s[Sums::stored], storable_ * days)},
          {"h_th/h_bed", "%", share(thickness, bed_height_)}};
}

std::vector<ReportLine> DayReport::lines() const {
  std::vector<ReportLine> all = lines_of(results_, results_[Sums::duration] / day_length);
  if (!(results_[Sums::duration] > 0)) {  // no day counts: zeros would look like answers
    for (ReportLine& line : all) line.value = std::numeric_limits<double>::quiet_NaN();
    return all;
  }
  if (results_[Sums::pumping] > 0)
    all.push_back({"pumping", "MWh/day",
                   results_[Sums::pumping] / megawatt_hour / (results_[Sums::duration] / day_length)});
  add_money(all);
  if (stress_.empty()) return all;
  const StressHistory::Factor least = stress_.static_factor(), dynamic = stress_.dynamic_factor();
  all.push_back({"FoS_static", "-", least.value});
  all.push_back({"FoS_static height", "m", least.z});
  all.push_back({"FoS_static time", "s", least.time});
  all.push_back({"FoS_dynamic", "-", dynamic.value});
  all.push_back({"FoS_dynamic height", "m", dynamic.z});
  return all;
}

/// Electricity and what it earns and costs, a year of days as those that count.
void DayReport::add_money(std::vector<ReportLine>& all) const {
  if (!p_.economics && plant_.parameters().tariff.empty()) return;
  const double years = results_[Sums::duration] / (365 * day_length);
  const double electricity = years > 0 ? results_[Sums::electricity] / megawatt_hour / years : 0;
  all.push_back({"electricity", "MWh/year", electricity});
  if (!plant_.parameters().tariff.empty())
    all.push_back({"revenue", "1/year", years > 0 ? results_[Sums::revenue] / years : 0});
  if (!p_.economics) return;
  const LevelisedCost cost = levelised_cost(*p_.economics, inventory_, electricity);
  all.push_back({"capital", "1", cost.capital});
  all.push_back({"capital of the storage", "1", cost.storage});
  all.push_back({"cost", "1/year", cost.per_year});
  all.push_back({"levelised cost", "1/MWh", cost.per_energy});
}

void DayReport::write_day(double time) {
  if (!days_) return;
  std::vector<double> row{time};
  for (const ReportLine& line : lines_of(day_, day_[Sums::duration] / day_length)) row.push_back(line.value);
  days_->row(row);
}

std::vector<std::string> DayReport::doubts() const {
  std::vector<std::string> sentences;
  const double days = results_[Sums::duration] / day_length;
  if (days_counted_ == 0 && p_.run_in > 0)
    sentences.push_back(fmt::format(
        "report: no day counts: the run has {} whole days, the first {:g} are the run-in (report.run-in); summary.csv {}",
        days_seen_, p_.run_in,
        days > 0 ? fmt::format("is that of its last {:.3g} h", 24 * days) : std::string("holds no numbers")));
  constexpr double year = 365;
  if (days > 0 && days < 0.95 * year && (p_.economics || !plant_.parameters().tariff.empty()))
    sentences.push_back(fmt::format(
        "report: {:.3g} days stand for a year in the electricity and its cost or revenue: they hold for a whole year's run "
        "alone",
        days));
  return sentences;
}

void DayReport::finish() {
  if (days_counted_ == 0) {
    stress_.end_day(true);
    results_.add(day_);
  }
  if (folder_.empty()) return;
  std::ofstream summary(own_file(folder_ / "summary.csv"));
  summary << "quantity,unit,value\n";
  for (const ReportLine& line : lines())
    summary << fmt::format("{},{},{}\n", line.quantity, line.unit, line.value);
  if (!stress_.empty()) {
    std::ofstream stress(own_file(folder_ / "stress.csv"));
    stress << "z [m],mean daily lowest share [-],mean daily highest share [-],highest share [-]\n";
    const std::vector<double> low = stress_.mean_lowest(), high = stress_.mean_highest();
    for (std::size_t i = 0; i < low.size(); ++i)
      stress << fmt::format("{},{},{},{}\n", stress_.z()[i], low[i], high[i], stress_.highest()[i]);
    stress.flush();
    if (!stress) throw Error("{} could not be written. Is the disk full?", (folder_ / "stress.csv").string());
  }
  summary.flush();
  if (!summary) throw Error("{} could not be written. Is the disk full?", (folder_ / "summary.csv").string());
}

std::vector<double> DayReport::state() const {
  std::vector<double> all{double(days_seen_), double(days_counted_), storable_, bed_height_, last_thickness_};
  all.insert(all.end(), day_.sum.begin(), day_.sum.end());
  all.insert(all.end(), results_.sum.begin(), results_.sum.end());
  const std::vector<double> stress = stress_.state();
  all.insert(all.end(), stress.begin(), stress.end());
  return all;
}

void DayReport::restore(std::span<const double> state) {
  days_seen_ = static_cast<int>(state[0]);
  days_counted_ = static_cast<int>(state[1]);
  storable_ = state[2];
  bed_height_ = state[3];
  last_thickness_ = state[4];
  state = state.subspan(5);
  for (ReportSums* sums : {&day_, &results_}) {
    std::copy_n(state.begin(), sums->sum.size(), sums->sum.begin());
    state = state.subspan(sums->sum.size());
  }
  stress_.restore(state);
}

}  // namespace couplet::thermocline
