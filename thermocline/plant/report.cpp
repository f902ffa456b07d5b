// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {
namespace {

/// Lowest height at which the profile, piecewise linear through the cell centers, reaches a temperature
/// between those of the lowest and highest cells.
double height_of(std::span<const double> z, std::span<const double> temperature, double wanted) {
  std::size_t i = 1;
  while (i + 1 < z.size() && temperature[i] < wanted) ++i;
  const double step = temperature[i] - temperature[i - 1];
  const double share = step > 0 ? (wanted - temperature[i - 1]) / step : 0;
  return z[i - 1] + share * (z[i] - z[i - 1]);
}

using Sums = ReportSums;

double share(double part, double whole) { return whole > 0 ? 100 * part / whole : 0; }

}  // namespace

std::optional<double> thermocline_thickness(std::span<const double> z, double height,
                                            std::span<const double> temperature, double cold, double hot) {
  const double bottom = temperature.front(), top = temperature.back();
  if (bottom >= hot || top <= cold) return std::nullopt;
  const double step = hot - cold;
  const bool cold_left = bottom > cold, hot_left = top < hot;
  if (cold_left && hot_left)
    return top > bottom ? std::optional(height * step / (top - bottom)) : std::nullopt;
  if (cold_left) return height_of(z, temperature, hot) * step / (hot - bottom);
  if (hot_left) return (height - height_of(z, temperature, cold)) * step / (top - cold);
  return height_of(z, temperature, hot) - height_of(z, temperature, cold);
}

void StressHistory::see(double time, std::span<const double> z, std::span<const double> equivalent,
                        std::span<const double> yield) {
  if (rings_.size() != z.size()) {
    rings_.assign(z.size(), {});
    for (std::size_t i = 0; i < z.size(); ++i) rings_[i].z = z[i];
    day_begun_ = false;
  }
  for (std::size_t i = 0; i < z.size(); ++i) {
    Ring& ring = rings_[i];
    const double share = equivalent[i] / yield[i];
    if (!day_begun_)
      ring.day_lowest = std::numeric_limits<double>::infinity(), ring.day_highest = 0,
      ring.day_highest_time = time;
    ring.day_lowest = std::min(ring.day_lowest, share);
    if (share > ring.day_highest) ring.day_highest = share, ring.day_highest_time = time;
  }
  day_begun_ = true;
}

void StressHistory::end_day(bool counts) {
  if (!std::exchange(day_begun_, false) || !counts) return;
  ++days_;
  for (Ring& ring : rings_) {
    ring.sum_lowest += ring.day_lowest;
    ring.sum_highest += ring.day_highest;
    if (ring.day_highest > ring.highest)
      ring.highest = ring.day_highest, ring.highest_time = ring.day_highest_time;
  }
}

StressHistory::Factor StressHistory::static_factor() const {
  const Ring& worst = *std::ranges::max_element(rings_, {}, &Ring::highest);
  return {1 / worst.highest, worst.z, worst.highest_time};
}

StressHistory::Factor StressHistory::dynamic_factor() const {
  Factor least{std::numeric_limits<double>::infinity(), 0, 0};
  for (const Ring& ring : rings_) {
    const double low = ring.sum_lowest / days_, high = ring.sum_highest / days_;
    const double factor = (1 - low) / (high - low);
    if (high > low && factor < least.value) least = {factor, ring.z, 0};
  }
  return least;
}

void declare(config::Section& s, ReportParameters& p) {
  s.value("run-in", p.run_in)
      .unit("day", 1, 1e4)
      .not_negative()
      .doc("number of initial days, in which the cycle becomes periodic, that are excluded from the means");
  s.value("profile-day", p.profile_day)
      .unit("day", 1, 1e4)
      .not_negative()
      .doc("on this day after the start, hourly profiles are written; default: none");
  as_difference(s.value("thickness-margin", p.thickness_margin))
      .positive()
      .doc(
          "the thermocline is the region between the cold temperature plus this margin and the hot temperature minus it");
  declare_section(
      s, "economics", p.economics,
      "prices, in any currency: the summary then includes capital and levelised cost of electricity");
}

void ReportSums::add(const ReportSums& other) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += other.sum[i];
}

constexpr double outlet_margin = 5;    // tolerance of outlets "near the design temperature" [K]
constexpr double dead_state = 318.15;  // T_ref of (5.29) [K]

/// Records a step of the bed. Returns the heat that the flow brought into it [J].
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
  largest_pump_ = std::max(largest_pump_, step.pump_power);
  const auto book = [&](double electricity) {
    day_[Sums::electricity] += electricity;
    day_[Sums::revenue] += plant_.tariff(step.t) * electricity / megawatt_hour;
  };
  const auto sell = [&](double heat) {
    day_[Sums::taken] += heat;
    book(plant.block_efficiency * heat);
  };
  book(-step.pump_power * dt);  // pump and fan are driven by the plant's own electricity
  sell(std::min(field, block));
  const auto mode = static_cast<PlantMode>(step.flow.mode);
  if (mode == PlantMode::standby) {
    day_[field > block ? Sums::charged_rest : Sums::discharged_rest] += dt;
    return 0;
  }
  const double inlet = step.flow.inlet_temperature;
  if (mode == PlantMode::charge) {
    day_[Sums::charging] += dt;
    if (outlet < plant.cold + outlet_margin) day_[Sums::cold_outlet] += dt;
    return mass * c * (inlet - outlet);
  }
  const double delivered = mass * c * (outlet - plant.cold);
  day_[Sums::discharging] += dt;
  if (outlet > plant.hot - outlet_margin) day_[Sums::hot_outlet] += dt;
  day_[Sums::delivered] += delivered;
  sell(delivered);
  day_[Sums::lacking] -= delivered;
  // (5.29)
  day_[Sums::exergy] += delivered - mass * c * dead_state * std::log(outlet / plant.cold);
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
  const double field = day_[Sums::field], asked = day_[Sums::asked], taken = day_[Sums::taken];
  for (const BedStep& step : record.steps) {
    const double heat = add_step(step);
    brought += heat;
    moved += step.flow.mass_flow * step.dt;
    if (static_cast<PlantMode>(step.flow.mode) != PlantMode::charge) continue;
    charged += heat;
    charging_time += step.dt;
  }
  // Heat brought by the flow and not stored was lost through walls, uniformly over the step (5.25-5.27).
  day_[Sums::stored] += charged - (brought - record.stored) * charging_time / record.dt;
  day_[Sums::losses] += record.losses;
  add_thickness(record);
  if (!record.equivalent_stress.empty())
    stress_.see(record.time, record.wall_z, record.equivalent_stress, record.yield_strength);
  if (series_)
    series_->row({record, weather_.at(record.time),
                  weather_.irradiation(record.time - record.dt, record.time) / record.dt, moved,
                  day_[Sums::field] - field, day_[Sums::asked] - asked, day_[Sums::taken] - taken,
                  last_thickness_});
  if (profiles_) write_profiles(record);
  last_time_ = record.time;
  // Times just before midnight count as midnight.
  if (record.time >= (days_seen_ + 1) * seconds_a_day - 1e-3) end_day(record.time);
}

bool DayReport::counts(int day) const { return day * seconds_a_day >= p_.run_in * seconds_a_day - 1; }

void DayReport::end_day(double time) {
  const bool counted = counts(days_seen_);
  ++days_seen_;
  stress_.end_day(counted);
  write_day(time);
  if (counted) {
    ++days_counted_;
    results_.add(day_);
  }
  day_ = {};
}

std::vector<ReportLine> DayReport::lines_of(const ReportSums& s, double days) const {
  const auto energy = [&](Sums::Item item) { return days > 0 ? s[item] / days / megawatt_hour : 0; };
  const auto time = [&](Sums::Item item) { return days > 0 ? s[item] / days / seconds_an_hour : 0; };
  const double thickness = s[Sums::thickness_time] > 0 ? s[Sums::thickness] / s[Sums::thickness_time] : 0;
  return {{"Q_SF", "MWh/day", energy(Sums::field), ", heat of the solar field"},
          {"Q_excess/Q_SF", "%", share(s[Sums::excess], s[Sums::field]), ", not used at once"},
          {"Q_C/Q_excess", "%", share(s[Sums::stored], s[Sums::excess]), ", stored part of the excess"},
          {"Q_D/Q_C", "%", share(s[Sums::delivered], s[Sums::stored]), ", recovered from storage"},
          {"B_D", "MWh/day", energy(Sums::exergy)},
          {"Q_lacking/Q_PB", "%", share(s[Sums::lacking], s[Sums::asked]), unmet_demand},
          {"energy losses", "MWh/day", energy(Sums::losses), " to the surroundings"},
          {"charge time", "h", time(Sums::charging)},
          {"discharge time", "h", time(Sums::discharging)},
          {"charged stand-by time", "h", time(Sums::charged_rest)},
          {"discharged stand-by time", "h", time(Sums::discharged_rest)},
          {"time with cold outlet", "%", share(s[Sums::cold_outlet], s[Sums::charging])},
          {"time with hot outlet", "%", share(s[Sums::hot_outlet], s[Sums::discharging])},
          {"eta_th", "%", share(s[Sums::stored], storable_ * days), ", use of the capacity"},
          {"h_th/h_bed", "%", share(thickness, bed_height_), ", thermocline thickness"}};
}

std::vector<ReportLine> DayReport::lines() const {
  std::vector<ReportLine> all = lines_of(results_, results_[Sums::duration] / seconds_a_day);
  if (!(results_[Sums::duration] > 0)) {  // no day counts: zeros would look like answers
    for (ReportLine& line : all) line.value = std::numeric_limits<double>::quiet_NaN();
    return all;
  }
  if (results_[Sums::pumping] > 0)
    all.push_back({"pumping", "MWh/day",
                   results_[Sums::pumping] / megawatt_hour / (results_[Sums::duration] / seconds_a_day)});
  add_money(all);
  if (stress_.empty()) return all;
  const StressHistory::Factor least = stress_.static_factor(), dynamic = stress_.dynamic_factor();
  all.push_back({"FoS_static", "-", least.value, ", safety against yield"});
  all.push_back({"FoS_static height", "m", least.z});
  all.push_back({"FoS_static time", "s", least.time});
  all.push_back({"FoS_dynamic", "-", dynamic.value, ", against ratcheting"});
  all.push_back({"FoS_dynamic height", "m", dynamic.z});
  return all;
}

void DayReport::refuse_other_run_in() const {
  constexpr int most_days = 1000000;
  if (days_seen_ < 0 || days_seen_ > most_days)
    throw Error("report: the checkpoint's day counts are damaged.");
  int counted = 0;
  for (int day = 0; day < days_seen_; ++day) counted += counts(day);
  if (counted != days_counted_)
    throw Error(
        "report.run-in: the run to be continued has completed {} days and counted {} of them; with a run-in of {:g} days it "
        "would be {}. Days already counted cannot be removed: keep the run-in, or start a new run.",
        days_seen_, days_counted_, p_.run_in, counted);
}

}  // namespace couplet::thermocline
