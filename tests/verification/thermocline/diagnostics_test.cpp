// SPDX-License-Identifier: Apache-2.0
// Findings of the tank's diagnostics.
#include "common/io/checkpoint.hpp"
#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::diagnostics_test {

/// A bed of 1 m through which salt flows from 290 to 390 degC.
TankParameters small_tank(double mass_flow) {
  TankParameters p;
  p.diameter = 2;
  p.bed.cells = 10, p.bed.layers = {{1, 0.25, 0.015}};
  p.bed.initial_temperature = kelvin(290);
  p.flow.type = FlowParameters::Type::schedule;
  p.flow.rows = {{0, mass_flow, kelvin(390), {}, {}}};
  return p;
}

/// The range of temperatures that findings are made of holds the start, of which a strong flow leaves nothing after a step.
TEST(Diagnostics, the_range_of_temperatures_begins_with_the_start) {
  TankRun run(small_tank(-2000));
  run.until(600, 600);
  EXPECT_NEAR(run.model().bed().bottom(), kelvin(390), 1e-3);
  const std::vector<std::string> closing = run.judged.conclude(false);
  EXPECT_TRUE(std::ranges::any_of(closing, [](const std::string& line) {
    return line.find("from 290 to 390 degC it falls") != std::string::npos;
  }));
}

TEST(Diagnostics, findings_turn_at_their_limits_and_belong_to_what_is_left_out) {
  const auto finding = [](const TankParameters& p, const char* id, double step = 60) {
    TankRun run(p);
    run.until(600, step);
    const auto all = run.found(id);
    EXPECT_LE(all.size(), 1u) << id;
    return all.empty() ? std::optional<diagnostics::Finding>() : std::optional(all.front());
  };
  const auto expect = [&](const TankParameters& p, const char* id, double limit, bool sound) {
    const auto found = finding(p, id);
    ASSERT_TRUE(found.has_value()) << id;
    EXPECT_DOUBLE_EQ(found->limit, limit) << id;
    EXPECT_EQ(found->severity == base::Severity::note, sound) << id << ": " << found->number;
    EXPECT_EQ(found->number <= limit, sound) << id << ": " << found->number;
  };
  TankParameters p = small_tank(-5);
  EXPECT_FALSE(finding(p, "resolved-grains")) << "the grains have shells";
  p.bed.shells = 1;
  expect(p, "resolved-grains", 0.05, true);
  p.filler.conductivity = {"0.003"};
  expect(p, "resolved-grains", 0.05, false);
  TankParameters liquid = p;
  for (BedLayer& layer : liquid.bed.layers) layer.porosity = 1;
  const auto of_liquid = finding(liquid, "resolved-grains");
  EXPECT_FALSE(of_liquid && of_liquid->number > 0) << "there are no grains";
  p.bed.advection = Advection::implicit;
  expect(p, "pressure-loss-of-the-bed", 0.05, true);
  p.pump.emplace();
  EXPECT_FALSE(finding(p, "pressure-loss-of-the-bed")) << "the pump is there";
  p.flow.rows.front().mass_flow = 5;  // hot from below
  expect(p, "mixing-of-inverted-fluid", 0.05, false);
  p.bed.mix_inversions = true;
  EXPECT_FALSE(finding(p, "mixing-of-inverted-fluid"));
  EXPECT_FALSE(finding(p, "compressibility")) << "a liquid";
  p.fluid.type = MediumInput::Type::air;
  p.flow.rows.front().mass_flow = -0.1;
  expect(p, "compressibility", 0.05, true);
  expect(p, "specific-heat-of-a-gas-by-its-temperature", 0.05, true);
  p.fluid.air_specific_heat = 1400;
  expect(p, "specific-heat-of-a-gas-by-its-temperature", 0.05, false);
  TankParameters wall = solar_one_parameters();
  wall.bed.cells = 100;
  TankRun run(wall);
  run.until(6 * 3600, 900);
  for (const char* id : {"yielding", "bending-of-the-wall"}) {
    ASSERT_EQ(run.found(id).size(), 1u) << id;
    EXPECT_EQ(run.found(id).front().limit, diagnostics::share_limit()) << id;
  }
}

TEST(Diagnostics, a_row_that_never_ran_is_said) {
  TankParameters p = small_tank(0);
  p.bed.initial_temperature = 450;
  const auto said = [&](const std::vector<ScheduleRow>& rows) {
    p.flow.rows = rows;
    TankRun run(p);
    run.until(200, 50);
    run.judged.conclude(false);
    const auto all = run.found("given-without-effect");
    EXPECT_EQ(all.size(), 1u);
    return all.empty() ? "" : all.front().sentence;
  };
  EXPECT_NE(said({{0, -10, 600, {}, 500.}, {100, 10, 500, {}, 400.}})
                .find("flow.rows[0] never ran: it stops below 226.85 degC"),
            std::string::npos);
  EXPECT_NE(said({{0, 0, 600, {}, {}}, {3600, 10, 500, {}, {}}})
                .find("no flow: the first row with a flow, flow.rows[1], starts at 3600 s"),
            std::string::npos);
  EXPECT_NE(said({{0, -10, 600, {}, {}}, {3600, -10, 500, {}, {}}})
                .find("flow.rows[1] starts at 3600 s, after the end of the run; of 2 rows 1 ran"),
            std::string::npos);
  EXPECT_NE(said({{0, -10, 600, {}, {}}, {10, -10, 500, {}, {}}}).find("its flow continued for"),
            std::string::npos);
  p.flow.rows = {{0, -10, 600, {}, {}}, {100, -10, 600, {}, {}}, {3600, -10, 500, {}, {}}};
  TankRun run(p);
  run.until(200, 50);
  run.judged.conclude(false);
  ASSERT_EQ(run.found("given-without-effect").size(), 1u);
  EXPECT_EQ(run.found("given-without-effect").front().severity, base::Severity::note)
      << "a short run of a long schedule is no fault";
}

/// A run may go on with more rows than it was saved with.
TEST(Diagnostics, a_saved_run_may_go_on_with_more_rows) {
  TankParameters p = small_tank(-10);
  TankRun first(p);
  first.until(100, 50);
  io::StateInMemory memory;
  io::CheckpointWriter writer(memory);
  io::Archive out(writer);
  first.judged.visit(out);
  writer.close();
  for (int i = 1; i < 40; ++i) p.flow.rows.push_back({100. * i, -10, kelvin(390), {}, {}});
  TankRun second(p);
  io::CheckpointReader reader(memory);
  io::Archive in(reader);
  second.judged.visit(in);
  second.until(4000, 50);
  second.judged.conclude(false);
  EXPECT_TRUE(second.found("given-without-effect").empty());
}

TEST(Diagnostics, capsules_that_did_not_melt_are_said) {
  TankParameters p = small_tank(0);
  p.flow = {}, p.bed.advection = Advection::implicit;
  const auto said = [&](double melts) {
    p.bed.layers[0].melting = Melting{kelvin(melts), 4, 150e3};
    TankRun run(p);
    run.until(60, 60);
    run.judged.conclude(false);
    return run.found("given-without-effect");
  };
  ASSERT_EQ(said(400).size(), 1u) << "all is at 290 degC";
  EXPECT_NE(said(400)[0].sentence.find("bed.layers[0]: its capsules melt from 398.0 to 402.0 degC"),
            std::string::npos);
  EXPECT_TRUE(said(290).empty());
}

TEST(Warnings, a_fluid_outside_the_range_of_its_own_tables_is_named_once) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 20;
  p.fluid.type = MediumInput::Type::custom;
  p.fluid.density = 700, p.fluid.specific_heat = 2700;
  p.fluid.temperature = {200, 300};  // degC were meant
  p.fluid.conductivity = {0.1, 0.1}, p.fluid.viscosity = {1e-3, 5e-4};
  TankRun run(p);
  run.until(1800, 900);
  const auto said = run.found("tank-state");
  ASSERT_EQ(said.size(), 1u);
  for (const char* part : {"conductivity and viscosity are given from -73.1 to 26.9 degC", "degC at z = "})
    EXPECT_NE(said[0].sentence.find(part), std::string::npos) << said[0].sentence;
  p.fluid.temperature = {kelvin(200), kelvin(300)};
  TankRun inside(p);
  inside.until(1800, 900);
  EXPECT_TRUE(inside.found("tank-state").empty());
}

TEST(Warnings, a_wall_outside_the_range_of_its_table_is_named_once_with_time_and_place) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 50;
  p.bed.initial_temperature = 373.15;
  TankRun run(p);
  run.until(1800, 900);
  const auto said = run.found("tank-state");
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].sentence.find("A537"), std::string::npos) << said[0].sentence;
  EXPECT_NE(said[0].sentence.find("from 204 to 304 degC"), std::string::npos) << said[0].sentence;
  run.until(3600, 900);
  EXPECT_EQ(run.found("tank-state").size(), 1u);
  TankRun inside(solar_one_parameters());
  inside.until(86400, 900);
  EXPECT_TRUE(inside.found("tank-state").empty());
}

}  // namespace couplet::thermocline::diagnostics_test
