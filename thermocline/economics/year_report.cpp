// SPDX-License-Identifier: Apache-2.0
// The day report's year: electricity, what it earns and costs, and how far the days of the run stand for a year.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "thermocline/economics/day_report.hpp"

namespace couplet::thermocline {
namespace {

constexpr double year = 365;  // [days]
using Sums = ReportSums;

}  // namespace

/// The days that count are one year or several of a weather that itself holds a year; a fiftieth may be missing.
bool DayReport::whole_years() const {
  const double years = results_[Sums::duration] / (year * seconds_a_day);
  return weather_.period_length() > 0.98 * year * seconds_a_day && std::round(years) >= 1 &&
         std::abs(years - std::round(years)) <= 0.02;
}

/// Electricity and what it earns and costs, a year of days as those that count. Net: pump and fan take their share.
void DayReport::add_money(std::vector<ReportLine>& all) const {
  if (largest_pump_ > 0) all.push_back({"largest power of pump or fan", "kW", largest_pump_ / 1000});
  if (!p_.economics && plant_.parameters().tariff.empty()) return;
  const double years = results_[Sums::duration] / (year * seconds_a_day);
  const char* const per = whole_years() ? "year" : "365 such days";
  const auto yearly = [&](double sum) { return years > 0 ? sum / years : 0; };
  const double electricity = yearly(results_[Sums::electricity]) / megawatt_hour;
  all.push_back({"electricity", fmt::format("MWh/{}", per), electricity});
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
  all.push_back({"levelised cost", "1/MWh", cost.per_energy});
}

std::vector<std::string> DayReport::doubts() const {
  std::vector<std::string> sentences;
  const double days = results_[Sums::duration] / seconds_a_day;
  if (days_counted_ == 0 && p_.run_in > 0)
    sentences.push_back(fmt::format(
        "report: no day counts: the run has {} whole days, but the first {:g} are the run-in "
        "(report.run-in); summary.csv {}",
        days_seen_, p_.run_in,
        days > 0 ? fmt::format("covers its last {:.3g} h", 24 * days) : std::string("contains no numbers")));
  if (p_.profile_day && *p_.profile_day * seconds_a_day >= last_time_)
    sentences.push_back(
        fmt::format("report: the run ended before profile-day {:g}: profiles.csv is empty", *p_.profile_day));
  if (const double sold = results_[Sums::electricity] / megawatt_hour;
      days > 0 && p_.economics && !(sold > 0))
    sentences.push_back(fmt::format(
        "report: the levelised cost is infinite: net electricity (power block minus pump and fan) = {:.3g} "
        "MWh{}",
        sold,
        sold < 0 ? "; they consume more than it produces" : ", no hour of the counted days produced any"));
  if (days <= 0 || whole_years() || !(p_.economics || !plant_.parameters().tariff.empty())) return sentences;
  const double period = weather_.period_length() / seconds_a_day;
  if (period < 0.98 * year && days > period)
    sentences.push_back(fmt::format(
        "report: the weather's {:.0f} days repeated {:.3g} times: the electricity and its cost or revenue "
        "are those of 365 such days, not of a year",
        period, days / period));
  else if (days < 0.98 * year)
    sentences.push_back(fmt::format(
        "report: {:.3g} days represent a year in the electricity and its cost or revenue: these are "
        "accurate only for a run over a whole year",
        days));
  else
    sentences.push_back(fmt::format(
        "report: the {:.4g} counted days are not a whole number of years: some days of the year have more "
        "weight than others in the electricity and its cost or revenue",
        days));
  return sentences;
}

}  // namespace couplet::thermocline
