// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::thermocline {

/// Load and tariff for certain days: one value, or 24 for the hours.
struct CalendarRule {
  std::vector<std::string> days;  ///< monday ... sunday, weekdays, weekend; empty means all days
  std::string from, to;           ///< MM-DD, inclusive; `to` may be in the next year; empty means all year
  std::vector<double> load, tariff;
};
void declare(config::Section& section, CalendarRule& rule);

/// First day of the run and period of its weather.
struct CalendarStart {
  std::string weekday;  ///< of the first day; required if a rule names weekdays
  int day = 0;          ///< first day of the weather, 0 for 01-01
  int period = 365;     ///< days until the weather repeats
};

/// Problem of the values of a day (neither one nor 24, or a load outside 0 to 1); empty if nothing is.
std::string problem_of_day(const std::vector<double>& values, bool share);
/// Value of the hour that contains t [s].
double at_hour(const std::vector<double>& values, double t);
/// Returns true for the name of a weekday.
bool is_weekday(const std::string& name);

/// Selects the first matching rule with a load (a tariff). Seasons follow the date of the weather, which may
/// repeat; weekdays continue through consecutive years of 365 days.
class Calendar {
 public:
  Calendar(const std::vector<CalendarRule>& rules, const CalendarStart& start);

  /// Values of the day that contains t [s]; nullptr if no rule has any.
  const std::vector<double>* load(double t) const;
  const std::vector<double>* tariff(double t) const;
  /// Rules that never apply, however long the run, as sentences.
  std::vector<std::string> doubts() const;

 private:
  struct Rule {
    unsigned weekdays = 0;  ///< bit 0: monday
    bool has_season = false;
    int from = 0, to = 0;  ///< days of the year
    std::vector<double> load, tariff;
  };
  bool holds(const Rule& rule, long day) const;
  const Rule* first(long day, std::vector<double> Rule::*values) const;

  std::vector<Rule> rules_;
  int weekday_, day_, period_;
};

/// Solar field, power block and operating limits of the store [thesis, section 5.2.1].
struct PlantParameters {
  double electric_power = 0;      ///< W_EG, day and night [W]
  double block_efficiency = 0.4;  ///< eta_PB
  double field_area = 0;          ///< S_SF [m^2]
  double field_efficiency = 0.6;  ///< eta_SF
  double hot = 0, cold = 0;       ///< design temperatures [K]
  double cut_off = 15;            ///< dT_CO [K]
  double restart = 10;            ///< dT_R [K]
  /// Temperature for the cut-off: the mixed temperature at the inlet of field or block (thesis text), or the
  /// outlet temperature of the tank (thesis tables). Mixtures use one for charging and the other for
  /// discharging: field: mixed and outlet; block: outlet and mixed.
  enum class CutOffAt { mixed, outlet, field, block } cut_off_at = CutOffAt::mixed;
  /// Requested share of the power block's output, constant or by the hour.
  std::vector<double> load{1};
  std::vector<double> tariff = {};  ///< of electricity, constant or hourly [currency/MWh]; may be empty
  std::vector<CalendarRule> calendar = {};  ///< days with other values
  CalendarStart start = {};                 ///< its weekday is a key, its days follow the weather
};
void declare(config::Section& section, PlantParameters& parameters);

enum class PlantMode { standby, charge, discharge };

/// Flows in the plant during one step.
struct PlantFlows {
  PlantMode mode = PlantMode::standby;
  double field_heat = 0;   ///< Q_SF: available from the sun, mean over the step [W]
  double block_heat = 0;   ///< Q_PB: requested by the power block [W]
  double field_flow = 0;   ///< m_SF [kg/s]
  double block_flow = 0;   ///< m_PB [kg/s]
  double field_inlet = 0;  ///< T_SF^in, mixed [K]
  double block_inlet = 0;  ///< T_PB^in, mixed [K]
  double tank_flow = 0;    ///< upward: > 0 discharge, < 0 charge [kg/s]
};

/// Plant management, equations 5.1 to 5.6. The specific heat is constant, so the mixing rules 5.5 and 5.6 and
/// the balances 5.3 and 5.4, each implicit in flow and temperature, have the closed solution
///   m_C = (Q_SF - Q_PB) / (c (T_hot - T_C)),   m_D = (Q_PB - Q_SF) / (c (T_D - T_cold)).
class Plant {
 public:
  /// `specific_heat`: specific heat of the fluid [J/(kg K)].
  Plant(const PlantParameters& parameters, double specific_heat);

  /// Flows of a step with initial outlet temperatures `top` and `bottom` [K]. `before`: mode of the previous
  /// step. A running process continues until the mixed temperature reaches its cut-off; otherwise it starts
  /// only within the restart tolerance. `load`: requested share of the design load.
  PlantFlows flows(double field_heat, double top, double bottom, PlantMode before, double load = 1) const;

  double field_heat(double irradiance) const;  ///< equation 5.2 [W]
  double block_heat() const;                   ///< equation 5.1, at the design load [W]
  /// At a time [s] from 00:00 of the first day: share of the design load, price [currency/MWh], and end of
  /// the hour if either depends on time (else infinity).
  double load(double t) const;
  double tariff(double t) const;
  double load_until(double t) const;
  const PlantParameters& parameters() const { return p_; }
  double specific_heat() const { return c_; }

 private:
  PlantFlows idle(double field_heat, double load) const;
  PlantFlows charge(double field_heat, double bottom, double load) const;
  PlantFlows discharge(double field_heat, double top, double load) const;

  PlantParameters p_;
  Calendar calendar_;
  double c_;
};

}  // namespace couplet::thermocline
