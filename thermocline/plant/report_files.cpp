// SPDX-License-Identifier: Apache-2.0
// Files of the day report, costs, and how well the days of the run represent a year.
#include "thermocline/plant/report.hpp"

#include <fmt/format.h>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "thermocline/material/numerics.hpp"

namespace couplet::thermocline {
namespace {

using Sums = ReportSums;

constexpr double year = 365;  // [days]

}  // namespace

DayReport::DayReport(const ReportParameters& parameters, const Plant& plant, const Weather& weather,
                     const std::filesystem::path& folder, double restart_time)
    : p_(parameters), plant_(plant), weather_(weather), folder_(folder) {
  if (folder_.empty()) return;
  std::vector<std::string> columns{"time [s]"};
  for (const ReportLine& line : lines_of({}, 1))
    columns.push_back(fmt::format("{} [{}]", line.quantity, line.unit));
  days_ = std::make_unique<io::Series>(folder_ / "days.csv", columns, restart_time);
  series_.emplace(
      folder_ / "plant.csv",
      std::vector<OutputColumn<StepRow>>{
          {"time [s]", [](const StepRow& v) { return v.record.time; }},
          {"solar field [W]", [](const StepRow& v) { return v.field / v.record.dt; }},
          {"power block [W]", [](const StepRow& v) { return v.taken / v.record.dt; }},
          {"demand [W]", [](const StepRow& v) { return v.asked / v.record.dt; }},
          {"tank flow [kg/s]", [](const StepRow& v) { return v.moved / v.record.dt; }},
          {"top [degC]", [](const StepRow& v) { return celsius(v.record.fluid_temperature.back()); }},
          {"bottom [degC]", [](const StepRow& v) { return celsius(v.record.fluid_temperature.front()); }},
          {"thermocline thickness [m]", [](const StepRow& v) { return v.thickness; }},
          {"losses [W]", [](const StepRow& v) { return v.record.losses / v.record.dt; }},
          {"irradiance [W/m^2]", [](const StepRow& v) { return v.dni; }},
          {"air [degC]", [](const StepRow& v) { return celsius(v.air.temperature); }},
          {"wind [m/s]", [](const StepRow& v) { return v.air.wind; }}},
      restart_time);
  constexpr static double none = std::numeric_limits<double>::quiet_NaN();
  if (p_.profile_day)
    profiles_.emplace(
        folder_ / "profiles.csv",
        std::vector<OutputColumn<BedCell>>{
            {"time [s]", [](const BedCell& v) { return v.record.time; }},
            {"z [m]", [](const BedCell& v) { return v.record.z[v.i]; }},
            {"fluid [degC]", [](const BedCell& v) { return celsius(v.record.fluid_temperature[v.i]); }},
            {"filler [degC]", [](const BedCell& v) { return celsius(v.record.filler_temperature[v.i]); }},
            {"wall [degC]",
             [](const BedCell& v) { return v.has_ring() ? celsius(v.record.wall_temperature[v.i]) : none; }},
            {"share of yield strength [-]",
             [](const BedCell& v) {
               return v.has_ring() ? v.record.equivalent_stress[v.i] / v.record.yield_strength[v.i] : none;
             }}},
        restart_time);
}

void DayReport::write_profiles(const TankRecord& record) {
  const double begin = *p_.profile_day * seconds_a_day;
  const double before = std::floor((record.time - record.dt - begin) / seconds_an_hour + clock_rounding);
  const double now = std::floor((record.time - begin) / seconds_an_hour + clock_rounding);
  if (now == before || now < 0 || now > 24) return;
  for (std::size_t i = 0; i < record.z.size(); ++i) profiles_->row({record, i});
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
  std::string summary = "quantity,unit,value\n";
  for (const ReportLine& line : lines())
    summary += fmt::format("{},{},{}\n", line.quantity, line.unit, line.value);
  base::write_file(folder_ / "summary.csv", summary);
  if (stress_.empty()) return;
  std::string stress = "z [m],mean daily lowest share [-],mean daily highest share [-],highest share [-]\n";
  for (const StressHistory::Ring& ring : stress_.rings())
    stress += fmt::format("{},{},{},{}\n", ring.z, ring.sum_lowest / stress_.days(),
                          ring.sum_highest / stress_.days(), ring.highest);
  base::write_file(folder_ / "stress.csv", stress);
}

void declare(config::Section& s, EconomicsParameters& p) {
  s.value("field", p.field).not_negative().doc("price per square meter of solar field");
  s.value("block", p.block).not_negative().doc("price per kilowatt (electric) of the power block");
  s.value("fixed", p.fixed).not_negative().doc("fixed cost, independent of the plant's size");
  s.value("steel", p.steel).not_negative().doc("price per kilogram of the tank's wall");
  s.value("filler", p.filler).not_negative().doc("price per kilogram of the grains");
  s.value("pump", p.pump)
      .not_negative()
      .doc("price per kilowatt of pump or fan, by the largest power in the run");
  s.value("fluid", p.fluid).not_negative().doc("price per kilogram of the fluid in the bed");
  s.value("insulation", p.insulation).not_negative().doc("price per square meter of insulated wall and roof");
  s.value("foundation", p.foundation).not_negative().doc("price per square meter of the tank's ground");
  s.value("operation", p.operation).range(0, 1).doc("annual cost, as a share of the capital");
  s.value("interest", p.interest).range(0, 1).doc("annual interest rate");
  s.value("lifetime", p.lifetime).range(1, 200).doc("lifetime in years");
  s.check(
      [&] {
        return p.field + p.block + p.fixed + p.steel + p.filler + p.pump + p.fluid + p.insulation +
                           p.foundation >
                       0
                   ? ""
                   : "all prices are 0: the levelised cost is undefined";
      },
      "");
}

LevelisedCost levelised_cost(const EconomicsParameters& p, const Inventory& i, double electricity) {
  LevelisedCost cost;
  cost.storage = p.steel * i.steel + p.filler * i.filler + p.fluid * i.fluid + p.insulation * i.insulated +
                 p.foundation * i.foundation + p.pump * i.pump_power / 1000;
  cost.capital = p.fixed + p.field * i.field_area + p.block * i.block_power / 1000 + cost.storage;
  const double grown = std::pow(1 + p.interest, p.lifetime);
  cost.annuity = p.interest > 0 ? p.interest * grown / (grown - 1) : 1 / p.lifetime;
  cost.per_year = (cost.annuity + p.operation) * cost.capital;
  cost.per_energy = electricity > 0 ? cost.per_year / electricity : std::numeric_limits<double>::infinity();
  return cost;
}

/// True if the counted days are whole years of weather that covers a year, to within 2 %.
bool DayReport::whole_years() const {
  const double years = results_[Sums::duration] / (year * seconds_a_day);
  return weather_.period_length() > 0.98 * year * seconds_a_day && std::round(years) >= 1 &&
         std::abs(years - std::round(years)) <= 0.02;
}

/// Adds the electricity with its revenue and cost, scaled to a year, net of pump and fan.
void DayReport::add_money(std::vector<ReportLine>& all) const {
  if (largest_pump_ > 0) all.push_back({"largest power of pump or fan", "kW", largest_pump_ / 1000});
  if (!p_.economics && plant_.parameters().tariff.empty()) return;
  const double years = results_[Sums::duration] / (year * seconds_a_day);
  const char* const per = whole_years() ? "year" : "365 such days";
  const auto yearly = [&](double sum) { return years > 0 ? sum / years : 0; };
  const double electricity = yearly(results_[Sums::electricity]) / megawatt_hour;
  all.push_back({"electricity", fmt::format("MWh/{}", per), electricity, " sold"});
  if (results_[Sums::pumping] > 0)
    all.push_back({"electricity of pump or fan", fmt::format("MWh/{}", per),
                   yearly(results_[Sums::pumping]) / megawatt_hour});
  if (!plant_.parameters().tariff.empty())
    all.push_back({"revenue", fmt::format("1/{}", per), yearly(results_[Sums::revenue])});
  if (!p_.economics) return;
  Inventory inventory = inventory_;
  inventory.pump_power = largest_pump_;
  const LevelisedCost cost = levelised_cost(*p_.economics, inventory, electricity);
  all.push_back({"capital", "1", cost.capital});
  all.push_back({"capital of the storage", "1", cost.storage});
  all.push_back({"cost", "1/year", cost.per_year});
  all.push_back({"levelised cost", "1/MWh", cost.per_energy, " of electricity"});
}

std::vector<std::string> DayReport::doubts() const {
  std::vector<std::string> sentences;
  const double days = results_[Sums::duration] / seconds_a_day;
  if (days_counted_ == 0 && p_.run_in > 0)
    sentences.push_back(fmt::format(
        "report: no day counts: the run has {} whole days, but the first {:g} are the run-in (report.run-in); summary.csv {}",
        days_seen_, p_.run_in,
        days > 0 ? fmt::format("covers its last {:.3g} h", 24 * days) : std::string("contains no numbers")));
  if (p_.profile_day && *p_.profile_day * seconds_a_day >= last_time_)
    sentences.push_back(
        fmt::format("report: the run ended before profile-day {:g}: profiles.csv is empty", *p_.profile_day));
  if (const double sold = results_[Sums::electricity] / megawatt_hour;
      days > 0 && p_.economics && !(sold > 0))
    sentences.push_back(fmt::format(
        "report: the levelised cost is infinite: net electricity (power block minus pump and fan) = "
        "{:.3g} MWh{}",
        sold,
        sold < 0 ? "; they consume more than it produces" : ", no hour of the counted days produced any"));
  if (days <= 0 || whole_years() || !(p_.economics || !plant_.parameters().tariff.empty())) return sentences;
  const double period = weather_.period_length() / seconds_a_day;
  if (period < 0.98 * year && days > period)
    sentences.push_back(fmt::format(
        "report: the weather's {:.0f} days repeated {:.3g} times: the electricity and its cost or "
        "revenue are those of 365 such days, not of a year",
        period, days / period));
  else if (days < 0.98 * year)
    sentences.push_back(fmt::format(
        "report: the electricity and its cost or revenue are extrapolated from {:.3g} days to a year: they are accurate only "
        "for a run over a whole year",
        days));
  else
    sentences.push_back(fmt::format(
        "report: the {:.4g} counted days are not a whole number of years, so that some days of the year have more weight than "
        "others in the electricity and its cost or revenue",
        days));
  return sentences;
}

}  // namespace couplet::thermocline
