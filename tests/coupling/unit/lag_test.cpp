// SPDX-License-Identifier: Apache-2.0
// What explicit coupling is told to leave, against what it leaves: the same masses on springs coupled implicitly.
#include <regex>

#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "tests/coupling/support/passing.hpp"
#include "tests/coupling/toy/piston.hpp"
#include "tests/coupling/toy/spring.hpp"

namespace couplet::lag_test {
using namespace coupling;

namespace fs = std::filesystem;

/// The piston, whose fluid drags the wall as well: F -= C w, w the mean velocity of a face's ends.
class Drag final : public tests::Passing<toy::Piston&> {
 public:
  Drag(toy::Piston& piston, double C) : Passing(piston), C_(C) {}
  Exchange solve(const Exchange& in) override {
    Exchange out = inner.solve(in);
    if (in.contains("velocity")) {
      const std::vector<double>& w = in.at("velocity");
      out.at("pressure-force")[1] -= C_ * (w[1] + w[3]) / 2;
    }
    return out;
  }

 private:
  double C_;
};

/// The spring, its way kept.
class Watched final : public tests::Passing<toy::Spring> {
 public:
  Watched(const toy::SpringParameters& p, std::vector<double>& way) : Passing(MPI_COMM_SELF, p), way_(way) {}
  Exchange solve(const Exchange& in) override {
    Exchange out = inner.solve(in);
    y_ = out.at("displacement")[1];
    return out;
  }
  StepReport accept_step() override {
    way_.push_back(y_);
    return inner.accept_step();
  }

 private:
  std::vector<double>& way_;
  double y_ = 0;
};

struct LagRun {
  double mu = 0.1, drag = 0, end = 10, dt = 0.05;  // mu: added mass over the structure's
  int order = 2;
  Scheme scheme = Scheme::explicit_;
  bool estimates = true;
  fs::path restart{}, folder = fs::temp_directory_path() / ("couplet-lag-" + std::to_string(::getpid()));
  std::vector<double> way{};
  std::string text{};

  /// Two masses of 0.5 kg, which swing with 1 rad/s together with the fluid.
  void operator()() {
    fs::create_directories(folder);
    coupler::CouplingParameters coupling;
    coupling.scheme = scheme;
    coupling.convergence.relative = 1e-12;
    coupling.predictor_order = order;
    app::SimulationParameters simulation;
    simulation.end_time = end, simulation.time_step = dt, simulation.error_estimate = estimates;
    toy::PistonParameters fluid;
    fluid.added_mass = mu, fluid.driving_force = 1;
    app::ParticipantContext context;
    context.comm = MPI_COMM_SELF;
    toy::Piston piston(context, fluid);
    Drag dragged(piston, drag);
    Watched spring({.mass = 0.5, .stiffness = (1 + mu) / 2}, way);
    coupler::CouplerChannels channels{std::make_unique<LocalChannel>("fluid", dragged),
                                      std::make_unique<LocalChannel>("solid", spring), nullptr};
    coupler::Coupler coupler(coupling, simulation, std::move(channels),
                             {folder, folder / "checkpoints", restart});
    spdlog::set_level(spdlog::level::info);
    testing::internal::CaptureStdout();
    const std::string problem = coupler.run();
    spdlog::default_logger()->flush();
    text = testing::internal::GetCapturedStdout();
    EXPECT_EQ(problem, "");
  }
  ~LagRun() { fs::remove_all(folder); }

  /// The number of the sentence; NaN: none.
  double told() const {
    std::smatch found;
    if (!std::regex_search(text, found,
                           std::regex("the error of explicit coupling is at most about ([-+.e0-9]+) of")))
      return std::nan("");
    return std::stod(found[1]);
  }
};

struct Setting {
  double mu, drag, end, dt;
  int order;
};

TEST(ExplicitLag, bounds_what_explicit_coupling_leaves) {
  // Added mass alone (errors of single steps cancel), drag alone (they add up), both; starts that jerk; a tenth of a
  // swing to eight swings; steps from 1/60 to 1/500 of a swing; motion that has died away to a tenth.
  const Setting settings[] = {{0.2, 0, 10, 0.1, 2},    {0.2, 0, 10, 0.0125, 2}, {0.2, 0, 50, 0.05, 2},
                              {0.2, 0, 10, 0.05, 1},   {0.2, 0, 50, 0.05, 1},   {0.02, 0, 10, 0.05, 2},
                              {0.02, 0, 1, 0.02, 2},   {0, 0.1, 10, 0.1, 2},    {0, 0.1, 10, 0.0125, 2},
                              {0, 0.1, 50, 0.05, 2},   {0, 0.1, 10, 0.05, 1},   {0.1, 0.1, 10, 0.05, 2},
                              {0.1, 0.1, 50, 0.05, 2}, {0.1, 0.1, 10, 0.05, 1}, {0.02, 0.02, 10, 0.0125, 2}};
  for (const Setting& s : settings) {
    LagRun lags{.mu = s.mu, .drag = s.drag, .end = s.end, .dt = s.dt, .order = s.order}, true_;
    lags();
    true_.mu = s.mu, true_.drag = s.drag, true_.end = s.end, true_.dt = s.dt, true_.scheme = Scheme::implicit;
    true_();
    ASSERT_EQ(lags.way.size(), true_.way.size());
    double error = 0, size = 0;
    for (std::size_t i = 0; i < lags.way.size(); ++i) {
      size = std::max(size, std::abs(lags.way[i]));
      if (4 * i >= 3 * lags.way.size()) error = std::max(error, std::abs(lags.way[i] - true_.way[i]));
    }
    EXPECT_GE(lags.told(), 0.9 * error / size)
        << "mu " << s.mu << " drag " << s.drag << " end " << s.end << " dt " << s.dt << " order " << s.order;
    if (s.mu == 0) {  // errors of single steps add up
      EXPECT_LE(lags.told(), 20 * error / size);
    }
    EXPECT_EQ(true_.text.find("the error of explicit coupling"), std::string::npos);
  }
}

TEST(ExplicitLag, is_said_to_be_unknown_where_no_step_could_be_looked_at) {
  LagRun shorter{.end = 0.15};
  shorter();
  EXPECT_TRUE(std::isnan(shorter.told())) << shorter.text;
  EXPECT_THAT(shorter.text,
              testing::HasSubstr("the error of explicit coupling is unknown (no step was examined"));
  LagRun off{.end = 1, .estimates = false};
  off();
  EXPECT_EQ(off.text.find("the error of explicit coupling"), std::string::npos);
}

TEST(ExplicitLag, changes_nothing_and_continues_over_a_restart_bit_for_bit) {
  LagRun whole{.drag = 0.1, .end = 2}, off{.drag = 0.1, .end = 2, .estimates = false},
      first{.drag = 0.1, .end = 1};
  whole();
  off();
  EXPECT_EQ(whole.way, off.way);
  first.folder += "-first";
  first();
  LagRun second{.drag = 0.1, .end = 2};
  second.folder += "-second";
  second.restart = app::find_checkpoint(first.folder / "checkpoints");
  second();
  EXPECT_EQ(second.way, std::vector(whole.way.begin() + 20, whole.way.end()));
  EXPECT_EQ(second.told(), whole.told());
  EXPECT_FALSE(std::isnan(whole.told()));
}

}  // namespace couplet::lag_test
