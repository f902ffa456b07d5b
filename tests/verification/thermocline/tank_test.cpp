// SPDX-License-Identifier: Apache-2.0
// The tank as a whole: books, subsets of elements, the participant's contract.
#include "thermocline/model/tank.hpp"
#include "common/io/checkpoint.hpp"
#include "tests/support/own_folder.hpp"
#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::tank_test {
using namespace coupling;

TEST(EnergyBalance, the_whole_tank_closes_over_a_week) {
  TankRun run(solar_one_parameters());
  run.until(7 * 86400, 900);
  const double moved = run.model().ledger().turnover;
  RecordProperty("imbalance", fmt::format("{:.3e}", std::abs(run.model().imbalance(run.time)) / moved));
  RecordProperty("bed", fmt::format("{:.3e}", std::abs(run.model().bed_imbalance()) / moved));
  EXPECT_LT(std::abs(run.model().imbalance(run.time)), 1e-6 * moved);
  EXPECT_LT(std::abs(run.model().bed_imbalance()), 1e-9 * moved);
  EXPECT_GT(run.model().ledger().side, 0);
  EXPECT_GT(run.model().ledger().roof, 0);
  EXPECT_GT(run.model().ledger().ground, 0);
}

TEST(Elements, any_subset_runs_and_closes_its_books) {
  for (int mask = 0; mask < 32; ++mask) {
    TankParameters p = solar_one_parameters();
    if (!(mask & 1)) p.mechanics.reset();
    if (!(mask & 2)) p.insulation.reset();
    if (!(mask & 4)) p.ullage.reset();
    if (!(mask & 8)) p.ground.reset();
    if (!(mask & 16)) p.shell.reset(), p.mechanics.reset(), p.insulation.reset();
    p.bed.cells = 50;
    TankRun run(p);
    run.until(6 * 3600, 900);
    const TankModel& m = run.model();
    EXPECT_LT(std::abs(m.imbalance(run.time)), 1e-6 * m.ledger().turnover) << mask;
    EXPECT_EQ(m.shell() != nullptr, p.shell.has_value());
    EXPECT_EQ(m.ledger().ground != 0, p.ground.has_value());
    EXPECT_EQ(m.ledger().side != 0, p.insulation.has_value());
    EXPECT_EQ(m.ledger().roof != 0, p.insulation.has_value() && p.ullage.has_value());
  }
}

/// Only the sky is colder than the air, and the blanket lets little of that in.
TEST(Elements, a_tank_at_the_temperature_of_its_surroundings_stays) {
  TankParameters p = solar_one_parameters();
  p.bed.initial_temperature = p.ambient.constant.temperature = 300;
  p.flow = {};
  TankRun run(p);
  run.until(5 * 86400, 900);
  const auto stays = [](double t) { return t < 300 + 1e-6 && t > 299.8; };
  EXPECT_TRUE(std::ranges::all_of(run.model().bed().fluid(), stays));
  EXPECT_TRUE(std::ranges::all_of(run.model().shell()->temperature(), stays));
}

TEST(Elements, nothing_gets_hotter_than_what_enters) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 100;
  for (const double step : {60.0, 900.0}) {
    p.exchange_step = step;
    TankRun run(p);
    for (double t = 1800; t < 86400; t += 1800) {
      run.until(t, 900);
      const auto wall = run.model().shell()->temperature();
      const auto fluid = run.model().bed().fluid();
      ASSERT_LE(*std::max_element(wall.begin(), wall.end()), 304.01 + zero_celsius) << "t = " << t;
      ASSERT_LE(*std::max_element(fluid.begin(), fluid.end()), 304.01 + zero_celsius) << "t = " << t;
    }
  }
}

TEST(Elements, shorter_exchange_steps_change_little) {
  TankParameters coarse = solar_one_parameters(), fine = coarse;
  coarse.exchange_step = 300, fine.exchange_step = 15;
  TankRun a(coarse), b(fine);
  a.until(20 * 3600, 900), b.until(20 * 3600, 900);
  double worst = 0, stress = 0;
  for (int i = 0; i < a.model().bed().grid().size(); ++i)
    worst = std::max(worst, std::abs(a.model().bed().fluid()[i] - b.model().bed().fluid()[i]));
  for (std::size_t i = 0; i < a.model().stress().hoop.size(); ++i)
    stress = std::max(stress, std::abs(a.model().stress().hoop[i] - b.model().stress().hoop[i]));
  RecordProperty("kelvin", fmt::format("{:.3f}", worst));
  RecordProperty("megapascal", fmt::format("{:.3f}", stress / 1e6));
  EXPECT_LT(worst, 1.0);
  EXPECT_LT(stress, 3e6);
}

/// A plate under thin cells holds more heat than the lowest of them, and the ground takes long steps of its
/// own.
TEST(Elements, thin_cells_on_a_heavy_plate_cool_without_swings) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 2000;
  p.ground->layers.insert(p.ground->layers.begin(), {"steel-plate", 0.02});
  p.ground->step = 3600;
  p.insulation.reset(), p.ullage.reset();
  p.flow = {};
  TankRun run(p);
  double before = run.model().bed().bottom();
  for (double t = 7200; t <= 2 * 86400; t += 7200) {
    run.until(t, 900);
    ASSERT_LE(run.model().bed().bottom(), before + 1e-6) << "t = " << t;
    before = run.model().bed().bottom();
  }
  EXPECT_LT(before, 203.9 + zero_celsius);
  EXPECT_GT(before, 150 + zero_celsius);
}

/// Its roof's cells answer within microseconds: they are solved with the gas, not beside it.
TEST(Elements, a_blanket_of_a_micrometre_loses_as_a_bare_tank_does) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 50;
  p.bed.initial_temperature = kelvin(304);
  p.flow = {};
  p.insulation->thickness = 1e-6;
  TankRun run(p);
  run.until(6 * 3600, 900);
  const TankModel& m = run.model();
  EXPECT_LT(std::abs(m.imbalance(run.time)), 1e-6 * m.ledger().turnover);
  EXPECT_LT(m.bed().steps(), 10000);
  // Roof: gas and radiation from 304 degC to a roof between that and the air's 20 degC.
  const double area = m.bed().area(), roof = m.ledger().roof / run.time / area;
  RecordProperty("roof", std::to_string(roof));
  EXPECT_GT(roof, 300);
  EXPECT_LT(roof, 3000);
}

/// Either way of joining roof and gas is of first order; on a blanket that both can do they agree.
TEST(Elements, the_implicit_answer_of_the_roof_is_that_of_its_explicit_steps) {
  std::vector<double> lost;
  for (const double step : {30.0, 900.0}) {
    TankParameters p = solar_one_parameters();
    p.bed.cells = 5;
    p.bed.initial_temperature = kelvin(304);
    p.flow = {}, p.ground.reset();
    p.insulation->thickness = 0.04;  // cells of 5 mm: their time constant is 6 s, 900 s are solved implicitly
    p.shell.reset(), p.mechanics.reset();
    p.exchange_step = step;
    TankRun run(p);
    run.until(4 * 3600, 900);
    lost.push_back(run.model().ledger().roof);
  }
  RecordProperty("ratio", std::to_string(lost[1] / lost[0]));
  EXPECT_NEAR(lost[1] / lost[0], 1, 0.01);
}

TEST(Column, what_it_answers_to_a_flow_is_what_its_step_does) {
  const Insulator wool = mineral_wool();
  for (const double thickness : {0.4, 1e-3}) {
    Column column({{wool, thickness, 8}}, 2.0);
    column.set_steady(500, 300);
    const Film outer{12, 290};
    const Film answer = column.inner_response(60, outer);
    const double own = column.inner_conductance(), power = 700;  // W
    column.step(60, power, outer);
    // Its surface then has T_0 + q/own; that must be what the answer says for this flow.
    const double surface = column.inner_temperature() + power / 2 / own;
    EXPECT_NEAR(answer.coefficient * (surface - answer.reference), power / 2, 1e-6 * power) << thickness;
  }
}

TEST(Bed, without_filler_has_the_fluids_temperature_where_grains_would_be) {
  for (const int shells : {1, 5})
    for (const Advection advection : {Advection::upwind, Advection::tvd, Advection::implicit}) {
      TankParameters p = solar_one_parameters();
      p.bed.cells = 40, p.bed.shells = shells, p.bed.advection = advection;
      p.bed.layers = {{6, 1, 0.01}, {6, 0.3, 0.01}};
      TankRun run(p);
      run.until(3 * 3600, 900);
      std::vector<double> filler;
      run.model().bed().filler_temperature(filler);
      for (int i = 0; i < 40; ++i) {
        EXPECT_GE(filler[i], kelvin(203.9)) << i;
        if (i < 20) {
          EXPECT_NEAR(filler[i], run.model().bed().fluid()[i], 1e-9) << i;
        }
      }
      EXPECT_LT(std::abs(run.model().imbalance(run.time)), 1e-6 * run.model().ledger().turnover);
    }
}

TEST(Schedule, repeats_its_rows_and_stops_at_the_outlet) {
  FlowTable s(solar_one_parameters().flow);
  const double hot = 304 + zero_celsius, cold = 204 + zero_celsius, hour = 3600;
  const Ambient air;
  EXPECT_EQ(s.decide(0, cold, cold, air).mass_flow, -90);
  EXPECT_EQ(s.decide(0, cold, cold, air).until, 9 * hour);
  EXPECT_EQ(s.decide(8 * hour, hot, cold + 5, air).mass_flow, 0);
  EXPECT_EQ(s.decide(8.5 * hour, hot, cold, air).mass_flow, 0) << "a flow that was stopped stays so";
  EXPECT_EQ(s.decide(9 * hour, hot, cold, air).mass_flow, 70);
  EXPECT_EQ(s.decide(17 * hour, hot - 5, cold, air).mass_flow, 0);
  EXPECT_EQ(s.decide(24 * hour, hot, cold, air).mass_flow, -70);
  EXPECT_EQ(s.decide(10 * 24 * hour + hour, hot, cold, air).mass_flow, -70);
  EXPECT_EQ(s.decide(10 * 24 * hour + hour, hot, cold, air).until, 10 * 24 * hour + 9 * hour);
  EXPECT_EQ(s.decide(10 * 24 * hour + 12 * hour, hot, cold, air).mass_flow, 70);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Monitor, a_run_that_goes_on_writes_the_rows_of_one_that_was_not_stopped) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 10;
  p.output.monitor_interval = 600;
  TankRun run(p);
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::filesystem::path folder = support::own_folder() / "monitor";
  for (const double stop : {none, 610.0, 1195.0, 1200.0}) {
    std::filesystem::remove_all(folder / "b");
    for (const char* name : {"a", "b"}) std::filesystem::create_directories(folder / name);
    auto files =
        std::make_unique<TankOutputFiles>(run.model(), folder / (std::isnan(stop) ? "a" : "b"), none);
    BedStep step;
    for (double t = 5; t < 3000; t += 5) {
      step.flow.mass_flow = t < 1000 ? 5 : 0, step.outlet_temperature = kelvin(20);
      files->monitor(run.model(), t, step);
      if (t == stop) files = std::make_unique<TankOutputFiles>(run.model(), folder / "b", stop);
    }
    files.reset();
    if (!std::isnan(stop)) {
      EXPECT_EQ(text_of(folder / "a" / "tank.csv"), text_of(folder / "b" / "tank.csv")) << stop;
    }
  }
  const std::string text = text_of(folder / "a" / "tank.csv");
  EXPECT_NE(text.find("\n600,5,20,20,"), std::string::npos) << text;
  EXPECT_NE(text.find("\n1200,0,nan,nan,"), std::string::npos) << "nothing comes in at rest";
}

class Participation : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("couplet-tank-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::unique_ptr<Tank> make() const {
    app::ParticipantContext context;
    context.name = "tank";
    context.output_folder = folder_;
    TankParameters p = solar_one_parameters();
    p.bed.cells = 60;
    return std::make_unique<Tank>(p, context);
  }
  static void take(Tank& tank, int n) {
    tank.begin_step({n * 900.0, 900, Scheme::standalone, n});
    tank.solve({});
    tank.accept_step();
  }
  static void expect_equal(const Tank& a, const Tank& b) {
    EXPECT_EQ(base::to_numbers(a.model()), base::to_numbers(b.model()));
  }
  std::filesystem::path folder_;
};

TEST_F(Participation, only_accepted_steps_change_the_state) {
  const auto a = make(), b = make();
  for (int n = 0; n < 50; ++n) {
    a->begin_step({n * 900.0, 450, Scheme::standalone, n});
    a->solve({});
    a->begin_step({n * 900.0, 900, Scheme::standalone, n});
    a->solve({});
    take(*a, n), take(*b, n);
  }
  expect_equal(*a, *b);
}

TEST_F(Participation, the_records_of_the_steps_add_up_to_the_ledger) {
  const auto tank = make();
  TankRecord all;
  const double start = tank->model().ledger().bed;
  for (int n = 0; n < 8; ++n) {
    take(*tank, n);
    const TankRecord r = tank->record();
    all.stored += r.stored, all.losses += r.losses;
  }
  const HeatSums& whole = tank->model().ledger();
  EXPECT_GT(std::abs(whole.ground), 1);
  EXPECT_NEAR(all.stored, whole.bed - start, 1e-9 * std::abs(whole.bed - start));
  EXPECT_NEAR(all.losses, whole.losses(), 1e-9 * std::abs(whole.losses()));
}

TEST_F(Participation, a_checkpoint_continues_bit_for_bit) {
  const auto a = make(), b = make();
  for (int n = 0; n < 45; ++n) take(*a, n);
  {
    io::CheckpointWriter writer(MPI_COMM_SELF, folder_ / "state.h5");
    a->save(writer);
    writer.close();
    io::CheckpointReader reader(MPI_COMM_SELF, folder_ / "state.h5");
    b->load(reader);
  }
  for (int n = 45; n < 100; ++n) take(*a, n), take(*b, n);
  expect_equal(*a, *b);
}

TEST_F(Participation, checkpoints_leave_a_run_as_it_is) {
  const auto never = make(), always = make();
  for (int n = 0; n < 60; ++n) {
    take(*never, n), take(*always, n);
    io::StateInMemory memory;
    io::CheckpointWriter writer(memory);
    always->save(writer);
    writer.close();
  }
  expect_equal(*never, *always);
}

/// A wall that answers as a membrane, in place of another program: u = R (p R/(E e) + integral of alpha dT).
TEST_F(Participation, a_wall_outside_that_is_a_membrane_gives_the_stress_of_the_rings) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 120;
  p.shell->plates = {{14, 0.016}};
  TankRun inside(p);
  p.external_wall.emplace();
  p.external_wall->sections = 240;
  app::ParticipantContext context;
  context.name = "tank";
  context.output_folder = folder_;
  context.coupled = true;
  Tank tank(p, context);
  const Interface interface = tank.initialise();
  const Steel steel = steel_a537();
  const double radius = p.diameter / 2, angle = p.external_wall->angle;
  Exchange answer;
  for (int n = 0; n < 4 * 24; ++n) {
    tank.begin_step({n * 900.0, 900, Scheme::explicit_, n});
    const Exchange given = tank.solve(answer);
    ASSERT_EQ(given.at("temperature").size(), interface.face_centres.size());
    const auto& t = given.at("temperature");
    std::vector<double> u(interface.vertices.size() * 3);
    for (std::size_t v = 0; v < interface.vertices.size(); ++v) {
      const std::size_t k = std::min(v / 2, t.size() - 1), below = k > 0 ? k - 1 : 0;
      double r = 0;
      for (const std::size_t i : {below, k})
        r += 0.5 * radius *
             (given.at("pressure")[i] * radius / (steel.youngs_modulus(t[i]) * 0.016) +
              steel.thermal_strain(t[i]));
      u[3 * v] = r * std::cos(angle / 2);
      u[3 * v + 1] = (v % 2 ? 1 : -1) * r * std::sin(angle / 2);
    }
    answer["displacement"] = std::move(u);
    tank.accept_step();
  }
  inside.until(24 * 3600, 900);
  double worst = 0, mean = 0, largest = 0;
  const auto &a = tank.model().stress().hoop, &b = inside.model().stress().hoop;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
    mean += std::abs(a[i] - b[i]) / a.size();
    largest = std::max(largest, b[i]);
  }
  RecordProperty("worst", fmt::format("{:.4f}", worst / largest));
  RecordProperty("mean", fmt::format("{:.4f}", mean / largest));
  EXPECT_LT(mean, 0.01 * largest);
  EXPECT_LT(worst, 0.05 * largest);
}

TEST_F(Participation, an_external_wall_needs_somebody_who_computes_it) {
  TankParameters p = solar_one_parameters();
  p.external_wall.emplace();
  app::ParticipantContext context;
  context.name = "tank";
  context.output_folder = folder_;
  EXPECT_THROW(Tank(p, context), Error);
}

}  // namespace couplet::thermocline::tank_test
