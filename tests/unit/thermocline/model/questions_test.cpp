// SPDX-License-Identifier: Apache-2.0
// What is asked about before a run: each sentence where it belongs, and none where all is well.
#include "tests/support/test.hpp"
#include "thermocline/model/model.hpp"

namespace couplet::thermocline::questions_test {
using testing::HasSubstr;

/// A plant's tank about which there is nothing to ask.
TankParameters sound() {
  TankParameters p;
  p.diameter = 10;
  p.bed.cells = 20;
  p.bed.layers = {{10, 0.3, 0.02}};
  p.bed.initial_temperature = kelvin(290);
  p.ambient_given.emplace();
  p.flow.type = FlowParameters::Type::plant;
  p.flow.plant = {50e6, 0.38, 510120, 0.70, kelvin(390), kelvin(290), 15, 10};
  return p;
}

TEST(Questions, a_restart_above_the_cut_off_is_said) {
  TankParameters p = sound();
  EXPECT_EQ(restart_beyond_cut_off(p.flow), "");
  p.flow.plant.cut_off = 5;
  EXPECT_THAT(restart_beyond_cut_off(p.flow), HasSubstr("flow.restart (10 K) is above flow.cut-off (5 K)"));
  p.flow.plant.cut_off = 10;
  EXPECT_EQ(restart_beyond_cut_off(p.flow), "");
}

TEST(Questions, air_and_sun_that_nobody_gave_are_said) {
  TankParameters p = sound();
  EXPECT_EQ(missing_weather(p), "");
  p.ambient_given.reset();
  EXPECT_THAT(missing_weather(p), HasSubstr("no sun, day and night"));
  p.flow = {};
  EXPECT_EQ(missing_weather(p), "") << "a bed alone has nothing to do with the air";
  p.ullage.emplace().height = 1;
  EXPECT_THAT(missing_weather(p), HasSubstr("still air of 20 degC"));
}

TEST(Questions, a_temperature_without_its_unit_is_refused) {
  TankParameters p = sound();
  EXPECT_EQ(forgotten_unit_of_bed(p), "");
  EXPECT_EQ(forgotten_unit_of_flow(p), "");
  p.bed.initial_temperature = 290;
  EXPECT_THAT(forgotten_unit_of_bed(p), HasSubstr("is 290 K, that is 16.9 degC"));
  EXPECT_THAT(forgotten_unit_of_bed(p), HasSubstr("write '290 degC'"));
  p.bed.initial_temperature = 100;  // frozen either way: the run warns
  EXPECT_EQ(forgotten_unit_of_bed(p), "");
  p.bed.profile_z = {0, 1}, p.bed.profile_temperature = {kelvin(290), 390};
  EXPECT_THAT(forgotten_unit_of_bed(p), HasSubstr("a value of profile-temperature is 390 K"));
  p.flow.plant.hot = 390;
  EXPECT_THAT(forgotten_unit_of_flow(p), HasSubstr("hot is 390 K"));
  p.flow = {};
  p.flow.type = FlowParameters::Type::schedule;
  p.flow.rows = {{0, 0, 0, {}, {}}, {10, -70, kelvin(390), 300, {}}};
  EXPECT_THAT(forgotten_unit_of_flow(p), HasSubstr("rows[1].stop-above is 300 K"));
  p.fluid.type = MediumInput::Type::caloria_ht43;
  EXPECT_EQ(forgotten_unit_of_flow(p), "") << "an oil is a liquid at 300 K";
  p.flow = {};
  p.bed = sound().bed;
  p.bed.initial_temperature = 204;
  EXPECT_THAT(forgotten_unit_of_bed(p), HasSubstr("is 204 K, that is -69.1 degC"));
}

TEST(Questions, capsules_that_cannot_melt_are_refused) {
  TankParameters p = sound();
  p.bed.layers[0].melting = Melting{298, 4, 150e3};
  EXPECT_THAT(forgotten_unit_of_bed(p), HasSubstr("layers[0].melting.temperature is 298 K"));
  p.bed.layers[0].melting->temperature = kelvin(400);
  EXPECT_EQ(forgotten_unit_of_bed(p), "");
}

TEST(Questions, seasons_need_a_weather_with_dates) {
  TankParameters p = sound();
  p.ambient.kind = WeatherKind::constant;
  p.flow.plant.calendar = {{{}, "", "", {0.5}, {}}};
  EXPECT_EQ(season_without_dates(p), "") << "all year";
  p.flow.plant.calendar.push_back({{}, "05-01", "09-30", {0.8}, {}});
  EXPECT_THAT(season_without_dates(p), HasSubstr("calendar[1] has a season"));
  p.ambient.kind = WeatherKind::clear_sky;
  EXPECT_EQ(season_without_dates(p), "");
}

TEST(Questions, prices_for_what_is_not_there_are_said) {
  EconomicsParameters prices;
  prices.steel = 6, prices.insulation = 200, prices.filler = 1, prices.field = 1;
  Inventory nothing;
  EXPECT_EQ(prices_for_nothing(prices, nothing, false).size(), 3u);
  EXPECT_THAT(prices_for_nothing(prices, nothing, false)[0],
              HasSubstr("report.economics.steel is 6, but has no effect"));
  EXPECT_TRUE(prices_for_nothing(prices, {.steel = 1, .filler = 1, .insulated = 1}, false).empty());
  EXPECT_TRUE(prices_for_nothing({}, nothing, false).empty());
  EconomicsParameters more;
  more.pump = 600;
  EXPECT_THAT(prices_for_nothing(more, nothing, false).at(0), HasSubstr("report.economics.pump is 600"));
  EXPECT_TRUE(prices_for_nothing(more, nothing, true).empty());
}

}  // namespace couplet::thermocline::questions_test
