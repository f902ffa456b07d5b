// SPDX-License-Identifier: Apache-2.0
// Load and tariff by the hour, levelised cost by hand.
#include "thermocline/plant/report.hpp"

#include "tests/support/test.hpp"
#include "thermocline/plant/flow.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline::economics_test {

TEST(Economics, levelised_cost_is_that_by_hand) {
  EconomicsParameters p;
  p.field = 200, p.block = 1000, p.fixed = 5e6, p.steel = 4, p.filler = 0.05, p.fluid = 0.8;
  p.insulation = 100, p.foundation = 400, p.operation = 0.02, p.interest = 0.07, p.lifetime = 25;
  const Inventory i{510120, 50e6, 400e3, 35758e3, 8487e3, 3200, 1372};
  // 102 024 000 + 50 000 000 + 5 000 000 + (1 600 000 + 1 787 900 + 6 789 600 + 320 000 + 548 800)
  const LevelisedCost c = levelised_cost(p, i, 158000);
  EXPECT_NEAR(c.storage, 11046300, 1e-6);
  EXPECT_NEAR(c.capital, 168070300, 1e-6);
  // 0.07 * 1.07^25/(1.07^25 - 1), 1.07^25 = 5.427432640116...
  EXPECT_NEAR(c.annuity, 0.0858105172206615, 1e-12);
  EXPECT_NEAR(c.per_energy, (0.0858105172206615 + 0.02) * 168070300 / 158000, 1e-6 * c.per_energy);
  // A pump by its largest power.
  Inventory more = i;
  more.pump_power = 250e3;
  p.pump = 600;
  EXPECT_NEAR(levelised_cost(p, more, 158000).storage, 11046300 + 150e3, 1e-6);
  p.interest = 0;
  EXPECT_NEAR(levelised_cost(p, i, 1).annuity, 0.04, 1e-15);
  EXPECT_TRUE(std::isinf(levelised_cost(p, i, 0).per_energy));
}

PlantParameters evening() {
  PlantParameters p{40e6, 0.4, 1e5, 0.5, 673.15, 573.15, 15, 10};
  p.load.assign(24, 0.0);
  for (int h = 17; h < 22; ++h) p.load[std::size_t(h)] = 0.5;
  p.tariff.assign(24, 40);
  p.tariff[18] = 120;
  return p;
}

TEST(Load, follows_the_clock_of_every_day) {
  const Plant plant(evening(), 1500);
  EXPECT_EQ(plant.load(16.99 * 3600), 0);
  EXPECT_EQ(plant.load(17 * 3600 - 1e-9), 0.5) << "rounding of a step's end";
  EXPECT_EQ(plant.load((24 * 9 + 18) * 3600.), 0.5);
  EXPECT_EQ(plant.tariff((24 * 9 + 18.5) * 3600.), 120);
  EXPECT_EQ(plant.load_until(17.2 * 3600), 18 * 3600);
  EXPECT_TRUE(std::isinf(Plant(PlantParameters{40e6, 0.4, 1e5, 0.5, 673.15, 573.15}, 1500).load_until(5)));
}

TEST(Load, half_a_load_takes_half_the_heat_and_none_leaves_the_field_to_the_tank) {
  const Plant plant(evening(), 1500);
  const PlantFlows half = plant.flows(0, 673.15, 573.15, PlantMode::discharge, 0.5);
  EXPECT_NEAR(half.tank_flow * 1500 * 100, 50e6, 1);
  const PlantFlows none = plant.flows(0, 673.15, 573.15, PlantMode::discharge, 0);
  EXPECT_EQ(none.mode, PlantMode::standby);
  EXPECT_EQ(none.tank_flow, 0);
  const PlantFlows sun = plant.flows(30e6, 673.15, 573.15, PlantMode::standby, 0);
  EXPECT_EQ(sun.mode, PlantMode::charge);
  EXPECT_NEAR(-sun.tank_flow * 1500 * 100, 30e6, 1);
  EXPECT_NEAR(sun.field_inlet, 573.15, 1e-9);
  PlantControl control{plant};
  EXPECT_EQ(control.decide(17 * 3600. - 30, 673.15, 573.15, {}).until, 17 * 3600)
      << "it looks again when the load changes";
}

/// A day of a block at rest but for 17 to 22 h at half load, without sun, from a full tank.
TEST(Load, report_counts_electricity_and_revenue) {
  WeatherParameters dark;
  const auto weather = make_weather(dark, ".");
  const Plant plant(evening(), 1500);
  ReportParameters parameters;
  parameters.economics.emplace();
  parameters.economics->fixed = 1e6, parameters.economics->interest = 0, parameters.economics->lifetime = 20;
  DayReport report(parameters, plant, *weather, {});
  const std::vector<double> z{1, 2}, dz{1, 1}, t{573.15, 673.15};
  for (int h = 0; h < 24; ++h) {
    BedStep step;
    step.t = h * 3600., step.dt = 3600;
    const bool runs = plant.load(step.t) > 0;
    step.flow.mode = int(runs ? PlantMode::discharge : PlantMode::standby);
    step.flow.mass_flow = runs ? 50e6 / 1500 / 100 : 0;
    step.flow.inlet_temperature = 573.15, step.outlet_temperature = 673.15;
    TankRecord record;
    record.time = step.t + 3600, record.dt = 3600;
    record.steps = {&step, 1};
    record.z = z, record.dz = dz, record.fluid_temperature = t, record.filler_temperature = t;
    record.heat_capacity = 1e10;
    report.record(record);
  }
  report.finish();
  std::map<std::string, double> found;
  for (const ReportLine& line : report.lines()) found[line.quantity] = line.value;
  // 5 h of 20 MW electric; an hour of it at 120.
  EXPECT_NEAR(found.at("electricity"), 100 * 365, 1e-6);
  EXPECT_NEAR(found.at("revenue"), (80 * 40 + 20 * 120) * 365, 1e-6);
  EXPECT_NEAR(found.at("levelised cost"), (0.05 + 0.02) * 1e6 / 36500, 1e-9);
  EXPECT_NEAR(found.at("Q_lacking/Q_PB"), 0, 1e-9);
}

/// A day at full load in the light of a sun that gives just that, with a pump of `pump` W.
std::map<std::string, double> sunny_day(double pump, std::vector<std::string>* units = nullptr,
                                        std::string* doubts = nullptr) {
  WeatherParameters sunny;
  sunny.constant.dni = 1000;
  const auto weather = make_weather(sunny, ".");
  PlantParameters p{40e6, 0.4, 2e5, 0.5, 673.15, 573.15, 15, 10};
  p.tariff = {50};
  ReportParameters parameters;
  parameters.economics.emplace().fixed = 1e6;
  DayReport report(parameters, Plant(p, 1500), *weather, {});
  const std::vector<double> z{1, 2}, dz{1, 1}, t{573.15, 673.15};
  for (int h = 0; h < 24; ++h) {
    BedStep step;
    step.t = h * 3600., step.dt = 3600, step.pump_power = pump;
    step.outlet_temperature = step.flow.inlet_temperature;
    TankRecord record;
    record.time = step.t + 3600, record.dt = 3600;
    record.steps = {&step, 1};
    record.z = z, record.dz = dz, record.fluid_temperature = t, record.filler_temperature = t;
    report.record(record);
  }
  report.finish();
  std::map<std::string, double> found;
  for (const ReportLine& line : report.lines()) {
    found[line.quantity] = line.value;
    if (units) units->push_back(line.unit);
  }
  if (doubts)
    for (const std::string& sentence : report.doubts()) *doubts += sentence + "\n";
  return found;
}

TEST(Economics, pump_and_fan_take_their_work_from_what_is_sold) {
  auto without = sunny_day(0), with = sunny_day(2e6);
  EXPECT_NEAR(without.at("electricity"), 40 * 24 * 365, 1e-6);
  EXPECT_NEAR(with.at("electricity"), 38 * 24 * 365, 1e-6);
  EXPECT_NEAR(with.at("electricity of pump or fan"), 2 * 24 * 365, 1e-6);
  EXPECT_NEAR(with.at("revenue"), 50 * 38 * 24 * 365, 1e-6);
  EXPECT_NEAR(with.at("largest power of pump or fan"), 2000, 1e-9);
  EXPECT_EQ(without.count("largest power of pump or fan"), 0u);
  EXPECT_NEAR(with.at("levelised cost") / without.at("levelised cost"), 40. / 38, 1e-9);
  std::string sound, doubts;
  sunny_day(2e6, nullptr, &sound);
  EXPECT_EQ(sound.find("infinite"), std::string::npos) << sound;
  EXPECT_TRUE(std::isinf(sunny_day(41e6, nullptr, &doubts).at("levelised cost")))
      << "it eats more than it gives";
  EXPECT_NE(doubts.find(
                "the levelised cost is infinite: net electricity (power block minus pump and fan) = -24 MWh"),
            std::string::npos)
      << doubts;
}

TEST(Economics, what_is_no_year_is_not_called_one) {
  std::vector<std::string> units;
  sunny_day(0, &units);
  EXPECT_EQ(std::count(units.begin(), units.end(), "MWh/365 such days"), 1);
  EXPECT_EQ(std::count(units.begin(), units.end(), "MWh/year"), 0);
}

}  // namespace couplet::thermocline::economics_test
