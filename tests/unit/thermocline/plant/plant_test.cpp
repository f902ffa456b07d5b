// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/plant.hpp"

#include "tests/unit/thermocline/support.hpp"
#include "thermocline/plant/flow.hpp"

namespace couplet::thermocline::plant_test {

constexpr double zero = 273.15;  // degC in K
const PlantParameters andasol{50e6, 0.38, 510120, 0.70, zero + 390, zero + 290, 15, 10};
const PlantParameters gemasolar{19.9e6, 0.40, 306658, 0.42, zero + 565, zero + 290, 15, 10};

TEST(Plant, power_block_asks_for_the_heat_of_the_thesis) {
  EXPECT_NEAR(Plant(andasol, salt).block_heat() * 86400 / 3.6e9, 3158, 0.5);
  EXPECT_NEAR(Plant(gemasolar, salt).block_heat() * 86400 / 3.6e9, 1194, 0.5);
}

struct State {
  PlantParameters parameters;
  double irradiance, top, bottom;
};
class PlantBalances : public testing::TestWithParam<State> {};

// Equations 5.3 to 5.6, each with the others' results put in.
TEST_P(PlantBalances, hold_to_rounding) {
  const auto& [p, irradiance, top_celsius, bottom_celsius] = GetParam();
  const double top = zero + top_celsius, bottom = zero + bottom_celsius;
  const Plant plant(p, salt);
  const double field = plant.field_heat(irradiance);
  const PlantMode wanted = field > plant.block_heat() ? PlantMode::charge : PlantMode::discharge;
  const PlantFlows f = plant.flows(field, top, bottom, wanted);
  ASSERT_EQ(f.mode, wanted);
  const double scale = plant.block_heat();
  EXPECT_NEAR(f.field_flow * salt * (p.hot - f.field_inlet), field, 1e-12 * scale);                // (5.3)
  EXPECT_NEAR(f.block_flow * salt * (f.block_inlet - p.cold), plant.block_heat(), 1e-12 * scale);  // (5.4)
  EXPECT_NEAR(f.block_flow - f.field_flow, f.tank_flow, 1e-12 * f.block_flow);
  if (wanted == PlantMode::charge) {
    EXPECT_LT(f.tank_flow, 0);
    EXPECT_NEAR(f.field_inlet * f.field_flow, f.block_flow * p.cold - f.tank_flow * bottom,
                1e-9 * f.field_flow * p.hot);
    EXPECT_NEAR(-f.tank_flow * salt * (p.hot - bottom), field - plant.block_heat(), 1e-12 * scale);
    EXPECT_EQ(f.block_inlet, p.hot);
    // The 2x2 of flow and mixed temperature, solved for the flow.
    EXPECT_NEAR(f.field_flow, (field / salt + f.block_flow * (p.cold - bottom)) / (p.hot - bottom),
                1e-12 * f.field_flow);
  } else {
    EXPECT_GT(f.tank_flow, 0);
    EXPECT_NEAR(f.block_inlet * f.block_flow, f.field_flow * p.hot + f.tank_flow * top,
                1e-9 * f.block_flow * p.hot);
    EXPECT_NEAR(f.tank_flow * salt * (top - p.cold), plant.block_heat() - field, 1e-12 * scale);
    EXPECT_EQ(f.field_inlet, p.cold);
  }
}
INSTANTIATE_TEST_SUITE_P(All, PlantBalances,
                         testing::Values(State{andasol, 800, 390, 290}, State{andasol, 700, 390, 303},
                                         State{andasol, 450, 390, 310}, State{andasol, 0, 390, 290},
                                         State{andasol, 200, 377, 290}, State{gemasolar, 850, 565, 310},
                                         State{gemasolar, 100, 552, 290}, State{gemasolar, 0, 565, 291}));

TEST(Plant, cut_off_looks_at_the_mixed_temperature) {
  const Plant plant(andasol, salt);
  const double field = plant.field_heat(700);
  // At the outlet of the tank the charge may go on well above cold + 15 K, because the block's cold flow
  // mixes in.
  const PlantFlows before = plant.flows(field, zero + 390, zero + 312, PlantMode::charge);
  EXPECT_EQ(before.mode, PlantMode::charge);
  EXPECT_LT(before.field_inlet, zero + 305);
  double outlet = 290;
  while (plant.flows(field, zero + 390, zero + outlet, PlantMode::charge).mode == PlantMode::charge)
    outlet += 0.01;
  const PlantFlows last = plant.flows(field, zero + 390, zero + outlet - 0.01, PlantMode::charge);
  EXPECT_NEAR(last.field_inlet, zero + 305, 0.02);
  EXPECT_GT(outlet, 315);
  // Discharge without sun mixes with nothing.
  EXPECT_EQ(plant.flows(0, zero + 375.01, zero + 290, PlantMode::discharge).mode, PlantMode::discharge);
  EXPECT_EQ(plant.flows(0, zero + 374.99, zero + 290, PlantMode::discharge).mode, PlantMode::standby);
}

TEST(Plant, cut_off_at_the_outlet_does_not_care_what_is_mixed_in) {
  PlantParameters p = andasol;
  p.cut_off_at = PlantParameters::CutOffAt::outlet;
  const Plant plant(p, salt);
  const double field = plant.field_heat(700), dusk = plant.field_heat(200);
  EXPECT_EQ(plant.flows(field, zero + 390, zero + 304.99, PlantMode::charge).mode, PlantMode::charge);
  EXPECT_EQ(plant.flows(field, zero + 390, zero + 305.01, PlantMode::charge).mode, PlantMode::standby);
  for (const double heat : {0.0, dusk}) {
    EXPECT_EQ(plant.flows(heat, zero + 375.01, zero + 290, PlantMode::discharge).mode, PlantMode::discharge);
    EXPECT_EQ(plant.flows(heat, zero + 374.99, zero + 290, PlantMode::discharge).mode, PlantMode::standby);
  }
  // The mixed rule goes on in both.
  const Plant mixed(andasol, salt);
  EXPECT_EQ(mixed.flows(field, zero + 390, zero + 305.01, PlantMode::charge).mode, PlantMode::charge);
  EXPECT_EQ(mixed.flows(dusk, zero + 374.99, zero + 290, PlantMode::discharge).mode, PlantMode::discharge);
}

TEST(Plant, cut_off_may_look_at_one_side_mixed_and_at_the_tank_on_the_other) {
  PlantParameters p = andasol;
  const double warm = zero + 305.01, cool = zero + 374.99;
  for (const auto at : {PlantParameters::CutOffAt::field, PlantParameters::CutOffAt::block}) {
    p.cut_off_at = at;
    const Plant plant(p, salt);
    const bool field = at == PlantParameters::CutOffAt::field;
    EXPECT_EQ(plant.flows(plant.field_heat(700), zero + 390, warm, PlantMode::charge).mode,
              field ? PlantMode::charge : PlantMode::standby);
    EXPECT_EQ(plant.flows(plant.field_heat(200), cool, zero + 290, PlantMode::discharge).mode,
              field ? PlantMode::standby : PlantMode::discharge);
  }
}

TEST(Plant, starts_again_only_within_the_restart_tolerance) {
  const Plant plant(andasol, salt);
  const double sun = plant.field_heat(800);
  EXPECT_EQ(plant.flows(sun, zero + 390, zero + 300.1, PlantMode::standby).mode, PlantMode::standby);
  EXPECT_EQ(plant.flows(sun, zero + 390, zero + 300.1, PlantMode::discharge).mode, PlantMode::standby);
  EXPECT_EQ(plant.flows(sun, zero + 390, zero + 300.1, PlantMode::charge).mode, PlantMode::charge);
  EXPECT_EQ(plant.flows(sun, zero + 390, zero + 299.9, PlantMode::standby).mode, PlantMode::charge);
  EXPECT_EQ(plant.flows(0, zero + 379.9, zero + 290, PlantMode::standby).mode, PlantMode::standby);
  EXPECT_EQ(plant.flows(0, zero + 379.9, zero + 290, PlantMode::discharge).mode, PlantMode::discharge);
  EXPECT_EQ(plant.flows(0, zero + 380.1, zero + 290, PlantMode::standby).mode, PlantMode::discharge);
}

TEST(Plant, standby_feeds_the_block_directly) {
  const Plant plant(andasol, salt);
  const PlantFlows full = plant.flows(plant.field_heat(900), zero + 390, zero + 380, PlantMode::standby);
  EXPECT_EQ(full.mode, PlantMode::standby);
  EXPECT_GT(full.field_heat, full.block_heat);
  EXPECT_EQ(full.tank_flow, 0);
  EXPECT_NEAR(full.field_flow, full.block_flow, 1e-12);
  const PlantFlows empty = plant.flows(plant.field_heat(100), zero + 300, zero + 290, PlantMode::standby);
  EXPECT_EQ(empty.mode, PlantMode::standby);
  EXPECT_LT(empty.field_heat, empty.block_heat);
  EXPECT_NEAR(empty.field_flow * salt * 100, plant.field_heat(100), 1e-3);
}

TEST(Plant, a_tank_that_is_hot_all_through_takes_nothing) {
  const Plant plant(andasol, salt);
  for (const double bottom : {390., 390.5, 400.}) {
    const PlantFlows f = plant.flows(plant.field_heat(900), zero + 390, zero + bottom, PlantMode::charge);
    EXPECT_EQ(f.mode, PlantMode::standby);
    EXPECT_TRUE(std::isfinite(f.tank_flow));
  }
}

TEST(PlantControl, remembers_its_mode_through_a_checkpoint) {
  PlantControl control{Plant(andasol, salt)};
  Ambient sun;
  sun.dni = 800;
  const Flow first = control.decide(0, 663.15, 563.15, sun);
  EXPECT_LT(first.mass_flow, 0);
  EXPECT_EQ(first.inlet_temperature, 663.15);
  EXPECT_GT(first.until, 0);
  PlantControl other{Plant(andasol, salt)};
  EXPECT_EQ(other.decide(60, 663.15, 575., sun).mass_flow, 0) << "a fresh one must not start here";
  other.memory = control.memory;
  EXPECT_LT(other.decide(60, 663.15, 575., sun).mass_flow, 0);
  Ambient night;
  const Flow discharge = other.decide(120, 663.15, 563.15, night);
  EXPECT_GT(discharge.mass_flow, 0);
  EXPECT_EQ(discharge.inlet_temperature, 563.15);
}

}  // namespace couplet::thermocline::plant_test
