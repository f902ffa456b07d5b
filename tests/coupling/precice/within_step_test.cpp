// SPDX-License-Identifier: Apache-2.0
// Values within a step: two tanks whose levels follow each other, each subdivides the step as it likes and is told the
// other's level at the ends of all its sub-steps. Against the monolithic scheme with the short steps.
#include "common/app/loop/step_loop.hpp"
#include "common/coupling/step_plan.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/support/test.hpp"

namespace couplet::within_step_test {
using namespace coupling;
using namespace coupler;

namespace fs = std::filesystem;
using Place = Interface::Place;
using Order = CouplingParameters::Exchange::Order;

/// level' = rate (other - level) by the trapezoidal rule in sub-steps; the other's level is a line between the values it has.
class Tank final : public Participant {
 public:
  Tank(std::string own, std::string other, double rate, double start, double others_start)
      : own_(std::move(own)), other_(std::move(other)), rate_(rate), level_(start), before_(others_start) {}

  Interface initialise() override {
    return {2, {{0, 0, 0}}, {}, {}, {{other_, "1", Place::vertices, 1}}, {{own_, "1", Place::vertices, 1}}};
  }
  void begin_step(const Step& step) override { step_ = step; }
  Exchange solve(const Exchange& in) override {
    if (fails_in > 0 && --fails_in == 0) throw SolveFailure("the tank runs over.");
    std::map<double, double> known{{0, before_}, {1, in.contains(other_) ? in.at(other_)[0] : before_}};
    for_within(in, other_,
               [&](double share, const std::string&, const auto& values) { known[share] = values[0]; });
    most_known = std::max(most_known, known.size());
    const auto at = [&](double share) {
      auto after = known.lower_bound(share - 1e-12);
      if (after == known.begin() || after->first - share < 1e-12) return after->second;
      const auto [t1, v1] = *after;
      const auto [t0, v0] = *--after;
      return v0 + (v1 - v0) * (share - t0) / (t1 - t0);
    };
    const int n = sub_steps + (wavers ? passes++ % 2 : 0);
    const double h = step_.dt / n;
    Exchange out;
    double x = level_;
    for (int k = 0; k < n; ++k) {
      const double share = double(k) / n, next = double(k + 1) / n;
      x = (x * (1 - rate_ * h / 2) + rate_ * h / 2 * (at(share) + at(next))) / (1 + rate_ * h / 2);
      out[k + 1 < n ? WithinStep::name(own_, next) : own_] = {x};
    }
    taken_ = known.at(1), next_ = x;
    return out;
  }
  StepReport accept_step() override {
    level_ = next_, before_ = taken_;
    return {.dt = step_.dt};
  }
  void save(io::CheckpointWriter& file) const override {
    file.write_common("level", std::array<double, 1>{level_});
    file.write_common("before", std::array<double, 1>{before_});
  }
  void load(io::CheckpointReader& file) override {
    io::Archive archive(file);
    archive.common("level", level_);
    archive.common("before", before_);
  }
  void write_output(double, int) override {}
  void write_monitors(double) override {}

  int sub_steps = 4, passes = 0, fails_in = 0;
  bool wavers = false;  // between two numbers of sub-steps
  std::size_t most_known = 0;

 private:
  std::string own_, other_;
  double rate_, level_, before_, next_ = 0, taken_ = 0;
  Step step_;
};

/// The tank's channel, which asks for values within the step.
class Asking final : public Channel {
 public:
  Asking(std::string name, Participant& tank, std::string datum)
      : channel_(std::move(name), tank), datum_(std::move(datum)) {}
  const std::string& name() const override { return channel_.name(); }
  void send(const Command& command) override { channel_.send(command); }
  Reply receive() override {
    Reply reply = channel_.receive();
    if (!datum_.empty()) reply.surfaces.within.insert(datum_);
    return reply;
  }

 private:
  LocalChannel channel_;
  std::string datum_;
};

struct Tanks {
  CouplingParameters coupling;
  app::SimulationParameters simulation;
  Tank left{"left-level", "right-level", 1, 1, -1}, right{"right-level", "left-level", 2, -1, 1};
  bool ask = true;
  fs::path folder = fs::temp_directory_path() / ("couplet-tanks-" + std::to_string(::getpid())), restart;
  int halvings = 0;
  long passes = 0;

  Tanks() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = Scheme::implicit;
    coupling.convergence.relative = 1e-12;
    coupling.convergence.max_iterations = 100;
    coupling.predictor_order = 0;
    coupling.mapping.type = MappingParameters::Type::nearest;
    coupling.acceleration.type = AccelerationParameters::Type::iqn_ils;
    coupling.exchange.emplace();
    coupling.exchange->participants = {"left", "right"};
    simulation.end_time = 2;
    simulation.time_step = 0.5;
  }
  ~Tanks() { fs::remove_all(folder); }
  /// Levels at the end.
  std::pair<double, double> operator()() {
    fs::create_directories(folder);
    std::vector<std::unique_ptr<Channel>> channels;
    channels.push_back(std::make_unique<Asking>("left", left, ask ? "right-level" : ""));
    channels.push_back(std::make_unique<Asking>("right", right, ask ? "left-level" : ""));
    Coupler coupler(MPI_COMM_SELF, coupling, simulation, std::move(channels),
                    {folder, folder / "checkpoints", restart});
    EXPECT_EQ(coupler.run(), "");
    halvings = coupler.halvings(), passes = coupler.iterations();
    return {coupler.given_by("left").at("left-level")[0], coupler.given_by("right").at("right-level")[0]};
  }
};

/// Both at once by the trapezoidal rule with steps of h from the levels given.
std::pair<double, double> monolithic(double h, int steps, double x = 1, double y = -1) {
  for (int k = 0; k < steps; ++k) {
    const double a = 1 + h / 2, b = -h / 2, c = -h, d = 1 + h, f = x + h / 2 * (y - x), g = y + h * (x - y);
    const double det = a * d - b * c;
    x = (f * d - b * g) / det, y = (a * g - c * f) / det;
  }
  return {x, y};
}

TEST(WithinStep, names_and_shares_come_back_and_other_names_are_none) {
  EXPECT_EQ(WithinStep::name("a b", 0.25), "a b@0.25");
  for (const double share : {1e-3, 0.1, 1 / 3., 0.7, 0.999}) {
    const auto found = WithinStep::parse(WithinStep::name("x@wall", share));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->first, "x@wall");
    EXPECT_NEAR(found->second, share, 1e-15);
  }
  for (const char* name : {"x", "x@", "@0.5", "x@0", "x@1", "x@-0.5", "x@0.5s", "x@nan", "x@wall"})
    EXPECT_FALSE(WithinStep::parse(name)) << name;
}

TEST(WithinStep, sub_steps_of_both_solve_the_monolithic_scheme_of_short_steps_in_any_order) {
  const auto [x, y] = monolithic(0.125, 16);
  for (const Order order : {Order::serial, Order::parallel})
    for (const auto type : {AccelerationParameters::Type::iqn_ils, AccelerationParameters::Type::constant}) {
      Tanks run;
      run.coupling.exchange->order = order;
      run.coupling.acceleration.type = type;
      run.coupling.acceleration.initial_relaxation = 0.8;
      run.coupling.acceleration.reused_steps = 2;
      const auto [left, right] = run();
      EXPECT_NEAR(left, x, 1e-10);
      EXPECT_NEAR(right, y, 1e-10);
      EXPECT_EQ(run.left.most_known, 5u);
      EXPECT_EQ(run.right.most_known, 5u);
    }
}

TEST(WithinStep, without_asking_only_the_ends_of_the_steps_go_over) {
  const auto [x, y] = monolithic(0.125, 16);
  Tanks run;
  run.ask = false;
  const auto [left, right] = run();
  EXPECT_EQ(run.left.most_known, 2u);
  EXPECT_EQ(run.right.most_known, 2u);
  EXPECT_GT(std::abs(left - x), 1e-4);
  EXPECT_NEAR(left, x, 0.1);
  EXPECT_NEAR(right, y, 0.1);
}

TEST(WithinStep, a_step_that_fails_is_tried_again_half_as_long_with_sub_steps_of_its_own) {
  Tanks run;
  run.simulation.end_time = 0.5;
  run.left.fails_in = 3;
  const auto [left, right] = run();
  EXPECT_EQ(run.halvings, 1);
  // Two steps of 0.25 s, four sub-steps in each.
  const auto [x, y] = monolithic(0.0625, 8);
  EXPECT_NEAR(left, x, 1e-10);
  EXPECT_NEAR(right, y, 1e-10);
}

TEST(WithinStep, a_run_continues_bit_for_bit) {
  Tanks whole, run;
  whole.folder += "-whole";
  whole.coupling.acceleration.reused_steps = run.coupling.acceleration.reused_steps = 3;
  const auto wanted = whole();
  run.simulation.end_time = 1;
  run();
  run.restart = app::find_checkpoint(run.folder / "checkpoints");
  run.simulation.end_time = 2;
  run.left = Tank{"left-level", "right-level", 1, 0, 0},
  run.right = Tank{"right-level", "left-level", 2, 0, 0};
  EXPECT_EQ(run(), wanted);
  EXPECT_EQ(run.passes, whole.passes) << "those before the restart count";
}

TEST(WithinStep, a_number_of_sub_steps_that_wavers_from_pass_to_pass_still_converges) {
  for (const Order order : {Order::serial, Order::parallel}) {
    Tanks run;
    run.coupling.exchange->order = order;
    run.coupling.acceleration.type = AccelerationParameters::Type::constant;
    run.coupling.acceleration.initial_relaxation = 1;
    run.coupling.convergence.relative = 1e-2;
    run.right.wavers = true;
    const auto [left, right] = run();
    const auto [x, y] = monolithic(0.02, 100);
    EXPECT_NEAR(left, x, 0.02);
    EXPECT_NEAR(right, y, 0.02);
  }
}

}  // namespace couplet::within_step_test
