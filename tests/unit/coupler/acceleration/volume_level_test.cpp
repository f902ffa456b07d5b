// SPDX-License-Identifier: Apache-2.0
// Closed fluids under masses on springs, in one process: what is pumped in is what the wall gives way.
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/coupling/toy/spring.hpp"
#include "tests/support/test.hpp"

namespace couplet::volume_level_test {
using namespace coupling;

namespace fs = std::filesystem;
using Place = Interface::Place;
using testing::HasSubstr;

/// A closed fluid of no more than its added mass under the line from x = a to b, which lets in Q = q sin^2(pi t): it
/// feels what its faces do beyond their mean, and has no level of its own.
class Bag final : public Participant {
 public:
  Bag(double a, double b, int faces, double added_mass, double q, double fails_above)
      : a_(a),
        h_((b - a) / faces),
        mass_(added_mass),
        q_(q),
        fails_above_(fails_above),
        now_(faces),
        next_(now_) {}
  Interface initialise() override {
    Interface line{2,
                   {},
                   {},
                   {},
                   {{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}},
                   {{"pressure-force", "N", Place::faces}, {"inflow", "m^3/s", Place::faces, 2}}};
    line.face_offset = {0};
    const int n = int(now_.size());
    for (int i = 0; i <= n; ++i) line.vertices.emplace_back(a_ + i * h_, 0, 0);
    for (int i = 0; i < n; ++i) {
      line.face_centres.emplace_back(a_ + (i + 0.5) * h_, 0, 0);
      line.face_areas.emplace_back(0, h_, 0);
      line.face_vertices.insert(line.face_vertices.end(), {i, i + 1});
      line.face_offset.push_back(2 * (i + 1));
    }
    return line;
  }
  void begin_step(const Step& step) override { step_ = step; }
  Exchange solve(const Exchange& in) override {
    if (step_.dt > fails_above_) throw SolveFailure("this step is too long.");
    const std::size_t n = now_.size();
    double mean = 0;
    for (std::size_t f = 0; f < n; ++f) {
      next_[f] = in.contains("velocity") ? (in.at("velocity")[2 * f + 1] + in.at("velocity")[2 * f + 3]) / 2
                                         : now_[f];
      mean += (next_[f] - now_[f]) / double(n);
    }
    Exchange out;
    for (std::size_t f = 0; f < n; ++f) {
      out["pressure-force"].insert(out["pressure-force"].end(),
                                   {0, weight_at(f) * h_ - mass_ * (next_[f] - now_[f] - mean) / step_.dt});
      out["inflow"].insert(out["inflow"].end(),
                           {inflow(step_.time + step_.dt) / double(n), inflow(step_.time) / double(n)});
    }
    return out;
  }
  /// Round-off from face to face, as a solver leaves it: no level cancels it.
  double weight_at(std::size_t f) const { return weight_ * (1 + 1e-14 * std::sin(double(f + 1))); }
  /// A pressure that is there at rest [Pa].
  void weigh(double weight) { weight_ = weight; }
  double inflow(double t) const { return at_once_ ? q_ : q_ * std::pow(std::sin(std::numbers::pi * t), 2); }
  /// The inflow has its size from the start.
  void begin_at_once(bool yes) { at_once_ = yes; }
  StepReport accept_step() override {
    now_ = next_;
    return {.dt = step_.dt};
  }
  void save(io::CheckpointWriter& file) const override { file.write("velocity", now_); }
  void load(io::CheckpointReader& file) override { file.read("velocity", now_); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 private:
  double a_, h_, mass_, q_, fails_above_, weight_ = 0;
  bool at_once_ = false;
  Step step_;
  std::vector<double> now_, next_;
};

struct BagRun {
  coupler::CouplingParameters coupling;
  app::SimulationParameters simulation;
  toy::SpringParameters spring;
  int bags = 1;
  bool at_once = false;
  double added_mass = 2, fails_above = 1, weight = 0, pumped = 0.1;
  fs::path folder = fs::temp_directory_path() / ("couplet-bag-" + std::to_string(::getpid())), restart;
  std::string problem;
  double iterations = 0;
  std::vector<double> position;
  std::vector<std::vector<double>> volume;  // rows of volume.csv

  BagRun() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = Scheme::implicit;
    coupling.acceleration.type = coupler::AccelerationParameters::Type::iqn_ils;
    coupling.mapping.type = coupler::MappingParameters::Type::nearest;
    coupling.exchange.emplace();
    simulation.end_time = 1;
    simulation.time_step = 0.02;
    simulation.max_step_halvings = 0;
    spring = {9, 0.5, 40};
  }
  ~BagRun() { fs::remove_all(folder); }
  BagRun(const BagRun&) = delete;

  void operator()() {
    fs::create_directories(folder);
    Bag left(0, bags == 1 ? 1 : 0.5, bags == 1 ? 8 : 4, added_mass, pumped, fails_above),
        right(0.5, 1, 4, added_mass, 0.03, fails_above);
    left.weigh(weight);
    left.begin_at_once(at_once);
    toy::Spring wall(MPI_COMM_SELF, spring);
    std::vector<std::unique_ptr<Channel>> channels;
    coupling.exchange->participants = {"left", "wall"};
    channels.push_back(std::make_unique<LocalChannel>("left", left));
    channels.push_back(std::make_unique<LocalChannel>("wall", wall));
    if (bags == 2) {
      coupling.exchange->participants = {"left", "right", "wall"};
      channels.push_back(std::make_unique<LocalChannel>("right", right));
    }
    coupler::Coupler coupler(MPI_COMM_SELF, coupling, simulation, std::move(channels),
                             {folder, folder / "checkpoints", restart});
    problem = coupler.run();
    iterations = double(coupler.iterations()) / double(std::max<GlobalIndex>(1, coupler.steps()));
    position = coupler.given_by("wall").at("displacement");
    read();
  }
  void read() {
    std::ifstream file(folder / "volume.csv");
    std::string line;
    std::getline(file, line);
    volume.clear();
    while (std::getline(file, line)) {
      std::vector<double> row;
      std::stringstream words(line);
      for (std::string word; std::getline(words, word, ',');) row.push_back(std::stod(word));
      volume.push_back(row);
    }
  }
  /// The volume under the wall itself, from x = a to b.
  double under(int first, int last) const {
    double sum = 0;
    for (int v = first; v < last; ++v) sum += (position[2 * v + 1] + position[2 * v + 3]) / 2 / 8;
    return sum;
  }
};

TEST(VolumeLevel, what_is_pumped_in_is_what_the_wall_gives_way_in_each_step) {
  for (const double mass : {0.1, 2., 20.}) {
    BagRun run;
    run.added_mass = mass;
    run();
    ASSERT_EQ(run.problem, "");
    ASSERT_EQ(run.volume.size(), 50u);
    double change = 0, inflow = 0;
    for (const auto& row : run.volume) {
      EXPECT_NEAR(row[2] - change, row[3] - inflow, 1e-10 * 0.05);
      change = row[2], inflow = row[3];
    }
    EXPECT_NEAR(run.under(0, 8), 0.05,
                1e-10);  // the integral of the inflow; the trapezoidal rule is exact here
    EXPECT_LE(run.iterations, 6) << mass;
    RecordProperty(fmt::format("iterations_{:g}", mass), fmt::format("{:.2f}", run.iterations));
  }
}

/// The level carries a load at rest where nothing flows; what is left of the wall's motion is round-off, by which a
/// level cannot be judged.
TEST(VolumeLevel, a_load_at_rest_is_carried_where_nothing_flows) {
  BagRun run;
  run.weight = -4905.1;
  run.pumped = 0;
  run.coupling.convergence.absolute = 1e-12;  // of round-off nothing relative can be asked
  run.simulation.end_time = 0.2;
  run();
  ASSERT_EQ(run.problem, "");
  ASSERT_EQ(run.volume.size(), 10u);
  for (const auto& row : run.volume) {
    EXPECT_NEAR(row[1], 4905.1, 1e-6);
    EXPECT_NEAR(row[2], 0, 1e-12);
  }
}

/// One face between two masses has nothing but the level: 2 m dv/dt + 2 k y = lambda over 1 m.
TEST(VolumeLevel, the_level_is_the_force_that_the_wall_needs) {
  BagRun run;
  run.spring.vertices = 2;
  run.simulation.end_time = 0.2;
  run();
  ASSERT_EQ(run.problem, "");
  double y = 0, v = 0;
  for (std::size_t n = 0; n < run.volume.size(); ++n) {
    const double v_new = 0.1 * std::pow(std::sin(std::numbers::pi * 0.02 * double(n + 1)), 2);
    const double y_new = y + 0.01 * (v + v_new);
    EXPECT_NEAR(run.volume[n][1], 2 * 0.5 * (v_new - v) / 0.02 + 2 * 40 * (y + y_new) / 2, 1e-7);
    y = y_new, v = v_new;
  }
}

TEST(VolumeLevel, two_cavities_under_one_wall_hold_their_own_volumes) {
  BagRun run;
  run.bags = 2;
  run();
  ASSERT_EQ(run.problem, "");
  for (const auto& row : run.volume) {
    EXPECT_NEAR(row[4], 0, 1e-10 * 0.05);
    EXPECT_NEAR(row[8], 0, 1e-10 * 0.05);
  }
  EXPECT_NEAR(run.under(0, 4), 0.05, 1e-10);
  EXPECT_NEAR(run.under(4, 8), 0.015, 1e-10);
  EXPECT_LE(run.iterations, 6);
}

/// A wall at rest cannot follow an inflow that is there at once: it overshoots, and the volume alone would let it
/// swing about the inflow for ever.
TEST(VolumeLevel, an_inflow_that_is_there_at_once_does_not_swing_on) {
  BagRun run;
  run.at_once = true;
  run.simulation.end_time = 0.8;
  run();
  ASSERT_EQ(run.problem, "");
  ASSERT_EQ(run.volume.size(), 40u);
  const auto flow = [&](std::size_t n) { return (run.volume[n][2] - run.volume[n - 1][2]) / 0.02; };
  double early = 0, late = 0, volume = 0;
  for (std::size_t n = 2; n < 8; ++n)
    early = std::max(early, std::abs(run.volume[n][1] - run.volume[n - 1][1]));
  for (std::size_t n = 34; n < 40; ++n)
    late = std::max(late, std::abs(run.volume[n][1] - run.volume[n - 1][1]));
  for (std::size_t n = 34; n < 40; ++n) volume = std::max(volume, std::abs(flow(n) / 0.1 - 1));
  EXPECT_GT(early, 100 * late);  // of the level, from step to step
  EXPECT_LT(volume, 1e-4);
  RecordProperty("level_swing", fmt::format("{:.2e} to {:.2e}", early, late));
}

TEST(VolumeLevel, a_step_that_is_halved_finds_it_anew) {
  BagRun run, fine;
  run.fails_above = 0.015;
  run.simulation.max_step_halvings = 2;
  run.simulation.end_time = fine.simulation.end_time = 0.1;
  fine.simulation.time_step = 0.01;
  run();
  fine();
  EXPECT_EQ(run.problem, "");
  ASSERT_EQ(run.volume.size(), 10u);
  for (const auto& row : run.volume) EXPECT_NEAR(row[4], 0, 1e-12);
  EXPECT_NEAR(run.volume.back()[1], fine.volume.back()[1], 1e-6 * fine.volume.back()[1]);
}

TEST(VolumeLevel, interrupted_run_equals_uninterrupted_run_bit_for_bit) {
  for (const int bags : {1, 2}) {
    BagRun whole;
    whole.bags = bags;
    whole();
    BagRun first;
    first.bags = bags;
    first.folder += "-first";
    first.simulation.end_time = 0.5;
    first();
    BagRun second;
    second.bags = bags;
    second.folder += "-second";
    second.restart = app::find_checkpoint(first.folder / "checkpoints");
    second();
    EXPECT_EQ(second.problem, "");
    EXPECT_EQ(second.position, whole.position);
    EXPECT_EQ(second.volume.back(), whole.volume.back());
  }
}

TEST(VolumeLevel, arrangements_that_cannot_hold_a_volume_are_refused) {
  BagRun lagged;
  lagged.coupling.scheme = Scheme::explicit_;
  EXPECT_THAT([&] { lagged(); }, testing::ThrowsMessage<Error>(HasSubstr("'left' is a closed fluid")));
  BagRun jacobi;
  jacobi.coupling.exchange->order = coupler::CouplingParameters::Exchange::Order::parallel;
  EXPECT_THAT([&] { jacobi(); }, testing::ThrowsMessage<Error>(HasSubstr("order: serial")));
}

}  // namespace couplet::volume_level_test
