// SPDX-License-Identifier: Apache-2.0
// Participants of any kind that exchange data once a step, in one process over local channels.
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "coupler/output/record.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/support/test.hpp"

namespace couplet::exchange_test {
using namespace coupling;
using namespace coupler;

namespace fs = std::filesystem;
using testing::HasSubstr;
using Place = Interface::Place;

/// A lump of heat capacity C with one face in contact with another: gives its temperature, or as the
/// `conductor` the heat C' (T - T_other) that it hands over, [W].
class Lump final : public Participant {
 public:
  Lump(double capacity, double temperature, double conductance)
      : capacity_(capacity), conductance_(conductance), now_(temperature), next_(temperature) {}
  Interface initialise() override {
    Interface i{3, {}, {Vec3(0, 0, 0)}, {Vec3(1, 0, 0)}, {}, {}};
    const Interface::Datum temperature{"temperature", "K", Place::faces, 1},
        heat{"heat", "W", Place::faces, 1};
    i.takes = {conductance_ > 0 ? temperature : heat};
    i.gives = {conductance_ > 0 ? heat : temperature};
    return i;
  }
  void begin_step(const Step& step) override { dt_ = step.dt; }
  Exchange solve(const Exchange& in) override {
    if (fails_above > 0 && dt_ > fails_above) throw SolveFailure("the step is too long.");
    if (conductance_ > 0) {
      const double other = in.contains("temperature") ? in.at("temperature").front() : now_;
      const double heat = conductance_ * (now_ - other);
      next_ = now_ - dt_ / capacity_ * heat;
      return {{"heat", {heat}}};
    }
    const double heat = in.contains("heat") ? in.at("heat").front() : 0;
    next_ = now_ + dt_ / capacity_ * heat;
    return {{"temperature", {next_}}};
  }
  StepReport accept_step() override {
    now_ = next_;
    return {.dt = dt_};
  }
  void save(io::CheckpointWriter& file) const override {
    file.write_common("temperature", std::array<double, 1>{now_});
  }
  void load(io::CheckpointReader& file) override { io::Archive(file).common("temperature", now_); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}
  double temperature() const { return now_; }
  double fails_above = 0;

 private:
  double capacity_, conductance_, now_, next_, dt_ = 0;
};

struct Pair {
  using Order = CouplingParameters::Exchange::Order;
  CouplingParameters coupling;
  app::SimulationParameters simulation;
  Lump hot{3, 400, 0.5}, cold{2, 300, 0};
  fs::path folder = fs::temp_directory_path() / ("couplet-exchange-" + std::to_string(::getpid()));
  fs::path restart;
  double iterations = 0;

  Pair() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = Scheme::explicit_;
    coupling.exchange.emplace();
    simulation.end_time = 4;
    simulation.time_step = 0.1;
  }
  ~Pair() { fs::remove_all(folder); }
  Pair(const Pair&) = delete;
  /// The cold one first, so that the hot one knows its temperature from the first step on.
  std::string run(Order order = Order::serial) {
    fs::create_directories(folder);
    coupling.exchange->order = order;
    std::vector<std::unique_ptr<Channel>> channels;
    channels.push_back(std::make_unique<LocalChannel>("cold", cold));
    channels.push_back(std::make_unique<LocalChannel>("hot", hot));
    coupling.exchange->participants = {"cold", "hot"};
    Coupler coupler(MPI_COMM_SELF, coupling, simulation, std::move(channels),
                    {folder, folder / "checkpoints", restart});
    const std::string problem = coupler.run();
    iterations = double(coupler.iterations()) / double(std::max<GlobalIndex>(1, coupler.steps()));
    return problem;
  }
  double difference() const { return hot.temperature() - cold.temperature(); }
};

TEST(Exchange, two_lumps_equalise_as_the_exact_solution_says_at_first_order) {
  std::vector<double> errors;
  for (const double dt : {0.1, 0.05, 0.025}) {
    Pair pair;
    pair.simulation.time_step = dt;
    ASSERT_EQ(pair.run(), "");
    errors.push_back(std::abs(pair.difference() - 100 * std::exp(-0.5 * (1. / 3 + 1. / 2) * 4)));
  }
  EXPECT_LT(errors[0], 3);
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 1, 0.15);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 1, 0.15);
}

TEST(Exchange, parallel_order_takes_all_values_from_the_last_step) {
  Pair serial, parallel;
  ASSERT_EQ(serial.run(), "");
  ASSERT_EQ(parallel.run(Pair::Order::parallel), "");
  EXPECT_NE(serial.difference(), parallel.difference());
  EXPECT_NEAR(serial.difference(), parallel.difference(), 2);
}

TEST(Exchange, a_step_that_one_cannot_solve_is_halved_for_all) {
  Pair pair;
  pair.hot.fails_above = 0.06;
  ASSERT_EQ(pair.run(), "");
  Pair fine;
  fine.simulation.time_step = 0.05;
  ASSERT_EQ(fine.run(), "");
  EXPECT_NEAR(pair.difference(), fine.difference(), 0.5);
}

TEST(Exchange, restart_continues_bit_for_bit) {
  Pair whole;
  whole.simulation.checkpoint_interval = 1;
  ASSERT_EQ(whole.run(), "");
  Pair rest;
  rest.restart = app::find_checkpoint(whole.folder / "checkpoints");
  rest.folder += "-rest";
  rest.simulation.end_time = 5;
  const double before = whole.hot.temperature();
  ASSERT_EQ(rest.run(), "");
  EXPECT_LT(rest.hot.temperature(), before);
  Pair uninterrupted;
  uninterrupted.folder += "-uninterrupted";
  uninterrupted.simulation.end_time = 5;
  ASSERT_EQ(uninterrupted.run(), "");
  EXPECT_EQ(rest.hot.temperature(), uninterrupted.hot.temperature());
  EXPECT_EQ(rest.cold.temperature(), uninterrupted.cold.temperature());
}

TEST(Exchange, what_another_run_has_left_in_the_folder_is_not_taken_for_this_ones) {
  Pair pair;
  fs::create_directories(pair.folder);
  for (const char* file : {"volume.csv", "balance.csv", "notes.txt"})
    std::ofstream(pair.folder / file) << "old";
  ASSERT_EQ(pair.run(), "");
  EXPECT_FALSE(fs::exists(pair.folder / "volume.csv"));
  EXPECT_FALSE(fs::exists(pair.folder / "balance.csv"));
  EXPECT_TRUE(fs::exists(pair.folder / "notes.txt")) << "not the coupler's";
}

std::vector<Side> sides() {
  const auto line = [](int n) {
    Interface i{3, {}, {}, {}, {}, {}};
    for (int k = 0; k < n; ++k) {
      i.face_centres.emplace_back(0, 0, (k + 0.5) / n);
      i.face_areas.emplace_back(1. / n, 0, 0);
    }
    return i;
  };
  Side bed{MPI_COMM_SELF, "bed", line(8)}, wall{MPI_COMM_SELF, "wall", line(2)};
  bed.interface.gives = {{"heat", "W", Place::faces, 1}, {"film-temperature", "K", Place::faces, 1}};
  wall.interface.takes = bed.interface.gives;
  return {bed, wall};
}

MappingParameters nearest() {
  MappingParameters mapping;
  mapping.type = MappingParameters::Type::nearest;
  return mapping;
}

TEST(Links, amounts_keep_their_sum_and_states_their_value) {
  const Links links(MPI_COMM_SELF, sides(), nearest());
  const std::vector<Exchange> given{
      {{"heat", {1, 2, 3, 4, 5, 6, 7, 8}}, {"film-temperature", std::vector<double>(8, 300.)}}, {}};
  const Exchange taken = links.input(1, given);
  EXPECT_THAT(taken.at("heat"), testing::ElementsAre(10, 26));
  EXPECT_THAT(taken.at("film-temperature"), testing::ElementsAre(300, 300));
  const auto amounts = links.amounts(given);
  ASSERT_EQ(amounts.size(), 2u);
  EXPECT_EQ(amounts[0].column, "bed gives heat [W]");
  EXPECT_EQ(amounts[0].value, 36);
  EXPECT_EQ(amounts[1].value, 36);
}

TEST(Links, data_not_yet_given_are_left_out) {
  const Links links(MPI_COMM_SELF, sides(), nearest());
  EXPECT_TRUE(links.input(1, {{}, {}}).empty());
}

TEST(Links, what_does_not_fit_is_named) {
  const auto message = [](const std::vector<Side>& s) {
    return support::error_of([&] { const Links links(MPI_COMM_SELF, s, nearest()); });
  };
  auto wrong = sides();
  wrong[1].interface.takes.push_back({"pressure", "Pa", Place::faces, 1});
  EXPECT_THAT(
      message(wrong),
      HasSubstr("'wall' takes 'pressure', but no participant gives it. Data available: 'heat' by 'bed'"));
  wrong = sides();
  wrong[1].interface.takes[1].unit = "degC";
  EXPECT_THAT(message(wrong), HasSubstr("'wall' takes 'film-temperature' in degC, but 'bed' gives it in K."));
  wrong = sides();
  wrong[1].interface.takes[0].components = 3;
  EXPECT_THAT(message(wrong), HasSubstr("'wall' takes 'heat' with 3 components, but 'bed' gives it with 1."));
  wrong = sides();
  wrong.push_back(wrong[0]);
  wrong.back().name = "ground";
  EXPECT_THAT(message(wrong), HasSubstr("'wall' takes 'heat', which both 'bed' and 'ground' give"));
}

}  // namespace couplet::exchange_test
