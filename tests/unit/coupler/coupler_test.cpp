// SPDX-License-Identifier: Apache-2.0
// The whole coupler in one process, over local channels: an added-mass fluid against masses on springs.
#include "coupler/coupler.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/coupling/support/passing.hpp"
#include "tests/coupling/toy/piston.hpp"
#include "tests/coupling/toy/spring.hpp"

namespace couplet::coupled_toy_test {
using namespace coupling;
using namespace coupler;

namespace fs = std::filesystem;

/// Moves nothing, but remembers what it was asked.
class RecordingMover final : public Participant {
 public:
  RecordingMover(const toy::PistonParameters& p, std::vector<std::string>& log) : piston_({}, p), log_(log) {}
  Interface initialise() override {
    Interface interface = piston_.initialise();
    interface.takes.pop_back();
    interface.gives.clear();
    return interface;
  }
  void begin_step(const Step&) override { log_.push_back("begin_step"); }
  Exchange solve(const Exchange& in) override {
    EXPECT_EQ(in.size(), 1u);
    EXPECT_TRUE(in.contains("displacement"));
    if (fails) throw SolveFailure("cell 7 is inverted.");
    log_.push_back("solve");
    if (motions) motions->push_back(in.at("displacement"));
    return {};
  }
  StepReport accept_step() override {
    log_.push_back("accept_step");
    return {};
  }
  void save(io::CheckpointWriter& file) const override {
    file.write_common("nothing", std::array<double, 1>{0});
  }
  void load(io::CheckpointReader&) override {}
  void write_output(double, int) override {}
  void write_monitors(double) override {}
  bool fails = false;
  std::vector<std::vector<double>>* motions = nullptr;

 private:
  toy::Piston piston_;
  std::vector<std::string>& log_;
};

/// A piston that pushes harder from the second pass of a step on, as a fluid that has renewed its prediction.
class RenewingPiston final : public tests::Passing<toy::Piston&> {
 public:
  RenewingPiston(toy::Piston& piston, double push, bool tells)
      : Passing(piston), push_(push), tells_(tells) {}
  void begin_step(const Step& step) override {
    passes_ = 0;
    inner.begin_step(step);
  }
  Exchange solve(const Exchange& in) override {
    Exchange out = inner.solve(in);
    if (++passes_ > 1) out.at("pressure-force")[1] += push_;
    return out;
  }
  bool renewed_prediction() const override { return tells_ && passes_ == 2; }

 private:
  double push_;
  bool tells_;
  int passes_ = 0;
};

/// A piston that keeps its first answer of each step, as a fluid whose first guess meets its solver's tolerance.
class DeafPiston final : public tests::Passing<toy::Piston&> {
 public:
  explicit DeafPiston(toy::Piston& piston) : Passing(piston) {}
  void begin_step(const Step& step) override {
    first_.clear();
    inner.begin_step(step);
  }
  Exchange solve(const Exchange& in) override {
    if (first_.empty()) first_ = inner.solve(in);
    return first_;
  }

 private:
  Exchange first_;
};

/// A spring that gives `times` its velocity.
class HastySpring final : public tests::Passing<toy::Spring&> {
 public:
  HastySpring(toy::Spring& spring, double times) : Passing(spring), times_(times) {}
  Exchange solve(const Exchange& in) override {
    Exchange out = inner.solve(in);
    for (double& v : out.at("velocity")) v *= times_;
    return out;
  }

 private:
  double times_;
};

/// One coupled run and its results.
struct ToyRun {
  CouplingParameters coupling;
  app::SimulationParameters simulation;
  toy::PistonParameters fluid;
  toy::SpringParameters solid;
  bool with_mover = false, mover_fails = false;
  double renewed_push = 0;  // 0: the piston itself
  bool tells = true;
  bool deaf = false;  // the piston keeps its first answer
  double times = 1;   // the velocity that the spring gives, over its own
  fs::path restart;

  std::vector<std::string> mover_log;
  std::vector<std::vector<double>> motions;  // that the mover was given
  std::string problem;
  int steps = 0, halvings = 0;
  double iterations_a_step = 0, position = 0, velocity = 0;
  fs::path folder = fs::temp_directory_path() / ("couplet-toy-" + std::to_string(::getpid()));

  ToyRun() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = Scheme::implicit;
    coupling.convergence.relative = 1e-10;
    simulation.end_time = 2;
    simulation.time_step = 0.05;
    fluid.driving_force = 1;
    solid.mass = 0.5;
    solid.stiffness = 2;
  }
  ~ToyRun() { fs::remove_all(folder); }
  ToyRun(const ToyRun&) = delete;

  /// One face between two masses: added mass over the mass of the structure.
  void mass_ratio(double ratio) { fluid.added_mass = ratio * 2 * solid.mass; }

  void operator()() {
    fs::create_directories(folder);
    app::ParticipantContext context;
    context.comm = MPI_COMM_SELF;
    toy::Piston piston(context, fluid);
    toy::Spring spring(MPI_COMM_SELF, solid);
    RecordingMover mover(fluid, mover_log);
    mover.fails = mover_fails;
    mover.motions = &motions;
    RenewingPiston renewing(piston, renewed_push, tells);
    DeafPiston deaf_one(piston);
    HastySpring hasty(spring, times);
    Participant& pusher = deaf                ? static_cast<Participant&>(deaf_one)
                          : renewed_push == 0 ? static_cast<Participant&>(piston)
                                              : renewing;
    tests::LocalCoupler coupler(coupling, simulation, pusher, hasty, with_mover ? &mover : nullptr,
                                {folder, folder / "checkpoints", restart});
    problem = coupler.run();
    steps = coupler.steps();
    halvings = coupler.halvings();
    iterations_a_step = double(coupler.iterations()) / std::max(1, steps);
    position = coupler.given_by("solid").at("displacement")[1];
    velocity = coupler.given_by("solid").at("velocity")[1];
  }

  /// M y'' + K y = F from rest, both masses together, solved at once by the trapezoidal rule.
  double monolithic_position() const {
    const double m = 2 * solid.mass + fluid.added_mass, k = 2 * solid.stiffness, dt = simulation.time_step;
    double y = 0, v = 0;
    for (int n = 0; n < std::lround(simulation.end_time / dt); ++n) {
      const double v_new = (m / dt * v - k * (y + dt / 4 * v) + fluid.driving_force) / (m / dt + k * dt / 4);
      y += dt / 2 * (v + v_new);
      v = v_new;
    }
    return y;
  }
};

TEST(CoupledToy, implicit_scheme_gives_the_monolithic_solution_for_any_mass_ratio) {
  for (const double ratio : {0.5, 1., 2., 5., 20.}) {
    ToyRun run;
    run.mass_ratio(ratio);
    run();
    EXPECT_EQ(run.problem, "") << ratio;
    EXPECT_EQ(run.steps, 40) << ratio;
    EXPECT_NEAR(run.position, run.monolithic_position(), 1e-9) << ratio;
    // A scalar linear map: Aitken is exact from its second factor on.
    EXPECT_LE(run.iterations_a_step, 3) << ratio;
  }
}

// A free mass, m_s dv/dt = -m_a dw/dt with w^{n+1} predicted, has the factor z of the velocity increments:
// w = v^n: z = -mu, stable for mu = m_a / m_s < 1; w = 2 v^n - v^{n-1}: z^2 + 2 mu z - mu = 0, stable for mu
// < 1/3.
TEST(CoupledToy, explicit_scheme_blows_up_above_the_mass_ratio_of_theory) {
  for (const auto& [order, limit] : {std::pair{1, 1.}, std::pair{2, 1. / 3}})
    for (const double factor : {0.9, 1.1}) {
      ToyRun run;
      run.coupling.scheme = Scheme::explicit_;
      run.coupling.predictor_order = order;
      run.simulation.end_time = 50;
      run.mass_ratio(factor * limit);
      run();
      const double still = run.fluid.driving_force / (2 * run.solid.stiffness);
      if (factor < 1) {
        EXPECT_EQ(run.problem, "");
        EXPECT_EQ(run.iterations_a_step, 1);
        EXPECT_LT(std::abs(run.position), 3 * still) << order;
        continue;
      }
      // It is named while it is still small, and the step is not halved for it.
      EXPECT_THAT(run.problem, testing::HasSubstr("added-mass instability of explicit coupling")) << order;
      EXPECT_EQ(run.halvings, 0);
      EXPECT_LT(run.steps, 80);
      EXPECT_LT(std::abs(run.position), 3 * still) << order;
      diagnostics::accept(std::vector<std::string>{"interface-oscillation"});
      run();
      diagnostics::accept({});
      EXPECT_EQ(run.problem, "");
      EXPECT_GT(std::abs(run.position), 1e3 * still) << order;
    }
}

TEST(CoupledToy, constant_relaxation_beyond_its_limit_is_named_within_a_few_passes_and_never_halved) {
  for (const double relaxation : {0.6, 0.75}) {  // the limit at a mass ratio of 2 is 2/3
    ToyRun run;
    run.mass_ratio(2);
    run.coupling.acceleration = {AccelerationParameters::Type::constant, relaxation, 1};
    run.coupling.convergence.max_iterations = 400;
    run();
    if (relaxation < 2. / 3) {
      EXPECT_EQ(run.problem, "");
      EXPECT_NEAR(run.position, run.monolithic_position(), 1e-8);
      continue;
    }
    EXPECT_THAT(run.problem, testing::HasSubstr("only relaxations below 0.66"));
    EXPECT_EQ(run.halvings, 0);
    EXPECT_EQ(run.steps, 0);
  }
}

TEST(CoupledToy, many_modes_converge_for_heavy_fluids) {
  for (const double ratio : {1., 20.}) {
    ToyRun run;
    run.fluid.vertices = run.solid.vertices = 21;
    run.fluid.added_mass = ratio * run.solid.mass;
    run.coupling.convergence.relative = 1e-6;
    run();
    EXPECT_EQ(run.problem, "") << ratio;
    EXPECT_EQ(run.halvings, 0) << ratio;
    EXPECT_LT(run.iterations_a_step, 30) << ratio;
    RecordProperty(fmt::format("iterations_at_ratio_{:g}", ratio),
                   fmt::format("{:.2f}", run.iterations_a_step));
  }
}

TEST(CoupledToy, semi_implicit_moves_the_mesh_once_a_step_and_implicit_each_iteration) {
  for (const Scheme scheme : {Scheme::semi_implicit, Scheme::implicit}) {
    ToyRun run;
    run.coupling.scheme = scheme;
    run.with_mover = true;
    run();
    EXPECT_EQ(run.problem, "");
    const auto moves = std::count(run.mover_log.begin(), run.mover_log.end(), "solve");
    const auto passes = std::lround(run.iterations_a_step * run.steps);
    EXPECT_EQ(moves, scheme == Scheme::semi_implicit ? run.steps : passes);
    EXPECT_EQ(std::count(run.mover_log.begin(), run.mover_log.end(), "accept_step"), run.steps);
  }
}

TEST(CoupledToy, mesh_on_guess_gives_the_mover_the_same_motion_in_all_passes_of_a_step) {
  for (const bool on_guess : {false, true}) {
    ToyRun run;
    run.with_mover = true;
    run.coupling.mesh_on_guess = on_guess;
    run.mass_ratio(2);
    run();
    EXPECT_EQ(run.problem, "");
    EXPECT_NEAR(run.position, run.monolithic_position(), 1e-9);
    ASSERT_GT(run.motions.size(), 2 * std::size_t(run.steps)) << "several passes a step";
    const std::set<std::vector<double>> places(run.motions.begin(), run.motions.end());
    if (on_guess)
      EXPECT_EQ(places.size(), std::size_t(run.steps));
    else
      EXPECT_GT(places.size(), std::size_t(run.steps));
  }
}

TEST(CoupledToy, a_step_that_fails_is_halved_until_it_can_be_solved) {
  ToyRun run;
  run.fluid.fails_above = 0.03;
  run();
  EXPECT_EQ(run.problem, "");
  EXPECT_GT(run.halvings, 0);
  EXPECT_EQ(run.steps, 80) << "two halves for each nominal step";
  ToyRun fine;
  fine.simulation.time_step = 0.025;
  fine();
  EXPECT_NEAR(run.position, fine.position, 1e-9) << "the same steps, found by halving";
}

TEST(CoupledToy, a_run_that_cannot_go_on_says_when_who_and_why) {
  ToyRun run;
  run.fluid.fails_above = 1e-6;
  run.simulation.max_step_halvings = 2;
  run();
  EXPECT_EQ(run.problem,
            "The step from t = 0 s failed, even with dt = 0.0125 s after 2 halvings: "
            "'fluid' reports: dt = "
            "0.0125 s is above 1e-06 s, the largest this piston can do. The state at t = 0 s was saved in " +
                (run.folder / "checkpoints").string() + ".");
}

TEST(CoupledToy, a_failed_mesh_motion_is_reported_with_the_movers_reason) {
  ToyRun run;
  run.with_mover = run.mover_fails = true;
  run.simulation.max_step_halvings = 0;
  run();
  EXPECT_THAT(run.problem, testing::HasSubstr("'mover' reports: cell 7 is inverted."));
}

TEST(CoupledToy, no_convergence_within_the_allowed_iterations_halves_the_step) {
  ToyRun run;
  run.fluid.vertices = run.solid.vertices = 21;
  run.fluid.added_mass = 20 * run.solid.mass;
  run.coupling.convergence.max_iterations = 2;
  run.simulation.max_step_halvings = 1;
  run();
  EXPECT_THAT(
      run.problem,
      testing::ContainsRegex(
          "the coupling did not converge in 2 iterations: the relative residual is [0-9.e+-]+ \\(tolerance 1.0e-10\\)"));
}

TEST(CoupledToy, differences_from_before_a_renewed_prediction_are_forgotten) {
  using Type = AccelerationParameters::Type;
  for (const Type type : {Type::aitken, Type::iqn_ils}) {
    std::array<double, 2> iterations{};
    for (const bool tells : {false, true}) {
      ToyRun run;
      run.mass_ratio(5);
      run.coupling.acceleration.type = type;
      run.renewed_push = 3;
      run.tells = tells;
      run();
      EXPECT_EQ(run.problem, "");
      iterations[tells] = run.iterations_a_step;
    }
    EXPECT_LT(iterations[1], iterations[0] - 0.5) << "type " << int(type);
    RecordProperty(fmt::format("iterations_{}", int(type)),
                   fmt::format("{:.2f} {:.2f}", iterations[0], iterations[1]));
  }
}

TEST(CoupledToy, a_velocity_that_is_not_the_rate_of_the_displacement_is_found_and_one_that_is_not) {
  const auto found = [] {
    return std::ranges::count(diagnostics::findings(), std::string("questionable-displacement"),
                              &diagnostics::Finding::id);
  };
  for (const double times : {1., 3., 0.2}) {
    ToyRun run;
    run.mass_ratio(0.5);
    run.times = times;
    const auto before = found();
    run();
    EXPECT_EQ(run.problem, "");
    ASSERT_EQ(found() - before, times == 1 ? 0 : 1) << times;
    if (times == 1) continue;
    const diagnostics::Finding& last = diagnostics::findings().back();
    EXPECT_EQ(last.severity, base::Severity::wrong);
    EXPECT_NEAR(last.number, times, 0.1 * times);
    EXPECT_THAT(last.sentence, testing::HasSubstr("velocity of 'solid'"));
  }
}

// A constant relaxation of 0.05 is too slow for 25 passes, whether the piston answers or not.
TEST(CoupledToy, a_step_that_fails_names_the_participant_that_did_not_answer) {
  ToyRun run;
  run.mass_ratio(0.9);
  run.coupling.acceleration = {AccelerationParameters::Type::constant, 0.05, 1};
  run.coupling.convergence.max_iterations = 25;
  run();
  EXPECT_THAT(run.problem, testing::HasSubstr("did not converge in 25 iterations"));
  EXPECT_THAT(run.problem, testing::Not(testing::HasSubstr("gave the same answer")));
  run.deaf = true;
  run();
  EXPECT_THAT(run.problem,
              testing::HasSubstr("'fluid' gave the same answer in 15 of the last 15 iterations"));
}

TEST(CoupledToy, a_step_that_is_accepted_unconverged_is_a_finding_and_a_useless_one_is_wrong) {
  const auto found = [] {
    return std::ranges::count(diagnostics::findings(), std::string("unconverged-step"),
                              &diagnostics::Finding::id);
  };
  const auto accepted = [&](int iterations, double relaxation) {
    ToyRun run;
    run.mass_ratio(0.9);
    run.coupling.acceleration = {AccelerationParameters::Type::constant, relaxation, 1};
    run.coupling.convergence.max_iterations = iterations;
    run.coupling.convergence.accepts_at_maximum = true;
    const auto before = found();
    run();
    EXPECT_EQ(run.problem == "", iterations > 1)
        << "one pass of 0.05 lets the motion oscillate: " << run.problem;
    return found() - before;
  };
  EXPECT_EQ(accepted(100, 0.5), 0);  // 1 - 0.5 (1 + 0.9) = 0.05 a pass
  EXPECT_GT(accepted(4, 0.5), 0);
  EXPECT_EQ(diagnostics::findings().back().severity, base::Severity::warning);
  EXPECT_GT(accepted(1, 0.05), 0);
  EXPECT_TRUE(std::ranges::any_of(diagnostics::findings(), [](const diagnostics::Finding& f) {
    return f.id == "unconverged-step" && f.severity == base::Severity::wrong && f.number >= 0.5;
  }));
}

TEST(CoupledToy, interrupted_run_equals_uninterrupted_run_bit_for_bit) {
  const auto setup = [](ToyRun& run) {
    run.fluid.vertices = run.solid.vertices = 11;
    run.fluid.added_mass = 3 * run.solid.mass;
  };
  ToyRun whole;
  setup(whole);
  whole();
  ToyRun first;
  setup(first);
  first.folder += "-first";  // the checkpoints of the whole run have gone further
  first.simulation.end_time = 1;
  first();
  ToyRun second;
  setup(second);
  second.folder += "-second";
  second.restart = app::find_checkpoint(first.folder / "checkpoints");
  second();
  EXPECT_EQ(second.problem, "");
  EXPECT_EQ(second.position, whole.position);
  EXPECT_EQ(second.velocity, whole.velocity);
}

}  // namespace couplet::coupled_toy_test
