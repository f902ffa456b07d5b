// SPDX-License-Identifier: Apache-2.0
// Added-mass theory [causin2005] against the coupler itself: a potential flow and an elastic wall in 40
// modes.
#include <fmt/ranges.h>

#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/coupling/support/residuals.hpp"
#include "tests/coupling/toy/modal.hpp"

namespace couplet::added_mass_test {
using namespace coupling;
using namespace coupler;

namespace fs = std::filesystem;
using Type = AccelerationParameters::Type;

/// Lets runs continue that oscillate with growing amplitude.
struct AcceptedOscillation {
  AcceptedOscillation() { diagnostics::accept(std::vector<std::string>{"interface-oscillation"}); }
  ~AcceptedOscillation() { diagnostics::accept({}); }
};

struct ModalRun {
  CouplingParameters coupling;
  app::SimulationParameters simulation;
  toy::ModalParameters p;
  fs::path folder = fs::temp_directory_path() / ("couplet-modal-" + std::to_string(::getpid()));
  std::string problem;
  std::vector<double> amplitudes, velocities;
  tests::Residuals residuals;

  ModalRun() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = Scheme::implicit;
    coupling.convergence.relative = 1e-6;
    coupling.convergence.max_iterations = 200;
    simulation.max_step_halvings = 0;
    p.inlet_pressure = 1;
    p.stiffness = 8;
    p.tension = 0.5;
  }
  ~ModalRun() { fs::remove_all(folder); }
  ModalRun(const ModalRun&) = delete;
  /// r = rho mu_1 / (rho_s h)
  void ratio(double r) { p.surface_density = p.density * toy::added_mass_length(p, 1) / r; }
  void steps(int n, double dt) {
    simulation.time_step = dt;
    simulation.end_time = n * dt;
  }
  void operator()() {
    fs::remove_all(folder);
    fs::create_directories(folder);
    toy::ModalChannel fluid(p);
    toy::ModalWall wall(p);
    {
      tests::LocalCoupler coupler(coupling, simulation, fluid, wall, nullptr,
                                  {folder, folder / "checkpoints", {}});
      problem = coupler.run();
    }
    amplitudes = wall.amplitudes();
    velocities = wall.velocities();
    residuals = tests::read_residuals(folder / "residuals.csv");
  }
};

/// The explicit scheme tells its user the ratio, from two passes more in a few steps; half of what it bears is the
/// bound: r = 0.5, and 1/6 with the predictor of order 2.
TEST(AddedMass, explicit_coupling_measures_the_mass_ratio_and_doubts_itself_beyond_half_its_limit) {
  for (const auto& [order, r, good] :
       {std::tuple{1, 0.49, true}, {1, 0.51, false}, {2, 0.163, true}, {2, 0.17, false}}) {
    ModalRun run;
    run.coupling.scheme = Scheme::explicit_;
    run.coupling.predictor_order = order;
    run.ratio(r);
    run.steps(20, 1e-3);
    run.p.pulse_duration = 0.02;
    run.p.stiffness = run.p.tension = 0;  // the mass alone
    run.p.vertices = 3;                   // one mode
    const int before = diagnostics::doubts();
    run();
    EXPECT_EQ(run.problem, "");
    EXPECT_EQ(diagnostics::doubts() - before, good ? 0 : 1) << "order " << order << ", r = " << r;
  }
}

/// Explicit coupling, w = v^n: m (v^{n+1} - v^n) = - rho mu (v^n - v^{n-1}), so the increments of the
/// velocity grow by r a step, whatever the step.
TEST(AddedMass, explicit_coupling_grows_by_the_mass_ratio_each_step) {
  const AcceptedOscillation accepted;
  for (const double inverse : {0.9, 0.99})
    for (const double dt : {1e-3, 1e-4}) {
      ModalRun run;
      run.coupling.scheme = Scheme::explicit_;
      run.coupling.predictor_order = 1;
      run.ratio(1 / inverse);
      run.p.pulse_duration = 10 * dt;
      std::vector<double> v;
      for (const int steps : {397, 398, 399, 400}) {
        run.steps(steps, dt);
        run();
        v.push_back(run.velocities[0]);
      }
      // Second differences: the alternating part, without the slow swing of the wall on its springs.
      const double before = v[2] - 2 * v[1] + v[0], after = v[3] - 2 * v[2] + v[1];
      EXPECT_NEAR(std::abs(after / before), 1 / inverse, 0.02 / inverse);
      RecordProperty(fmt::format("growth_{}_{}", inverse, dt),
                     fmt::format("{:.6f}", std::abs(after / before)));
      EXPECT_LT(after / before, 0) << "the sign alternates";
    }
}

TEST(AddedMass, explicit_coupling_is_bounded_below_a_mass_ratio_of_one) {
  for (const double inverse : {1.01, 1.1}) {
    ModalRun run;
    run.coupling.scheme = Scheme::explicit_;  // with its own predictor; one of order 2 grows from 1/3
    run.ratio(1 / inverse);
    run.p.pulse_duration = 0.1;
    run.steps(2000, 1e-3);
    run();
    // The pulse moves the wall by about t^2 p / 2 m; ten times of that would be growth.
    const double scale = run.p.inlet_pressure * 0.05 * 2 / run.p.surface_density;
    EXPECT_LT(std::abs(run.amplitudes[0]), scale) << inverse;
    RecordProperty(fmt::format("amplitude_{}", inverse),
                   fmt::format("{:.6f}", std::abs(run.amplitudes[0]) / scale));
  }
}

TEST(AddedMass, plain_iteration_contracts_by_the_first_mass_ratio) {
  for (const double r : {0.3, 0.5, 0.8}) {
    ModalRun run;
    run.coupling.acceleration.type = Type::constant;
    run.coupling.acceleration.initial_relaxation = 1;
    run.coupling.convergence.relative = 1e-10;
    run.ratio(r);
    run.steps(1, 1e-3);
    run();
    ASSERT_EQ(run.problem, "");
    // Late in the step one mode is left. The wall's stiffness adds a dt^2 / 4 to its mass: nothing here.
    const auto& rows = run.residuals.steps.front();
    ASSERT_GT(rows.size(), 10u);
    const double slope = rows[rows.size() - 2].absolute / rows[rows.size() - 3].absolute;
    EXPECT_NEAR(slope, r, 0.02 * r);
    RecordProperty(fmt::format("contraction_{}", r), fmt::format("{:.6f}", slope));
  }
}

TEST(AddedMass, plain_iteration_diverges_above_a_mass_ratio_of_one) {
  ModalRun run;
  run.coupling.acceleration.type = Type::constant;
  run.coupling.acceleration.initial_relaxation = 1;
  run.coupling.convergence.relative = 1e-10;
  run.ratio(1.25);
  run.steps(1, 1e-3);
  run();
  EXPECT_NE(run.problem, "");
  RecordProperty("cause", run.problem);
}

int most_iterations(ModalRun& run) {
  std::size_t most = 0;
  for (const auto& step : run.residuals.steps) most = std::max(most, step.size());
  return int(most);
}

TEST(AddedMass, iterations_of_aitken_and_quasi_newton) {
  struct Bar {
    double r;
    int aitken, newton;
  };
  for (const Bar& bar : {Bar{0.5, 9, 6}, Bar{5, 17, 9}, Bar{50, 46, 15}})
    for (const Type type : {Type::aitken, Type::iqn_ils}) {
      ModalRun run;
      run.coupling.acceleration.type = type;
      run.coupling.acceleration.initial_relaxation = 1 / (1 + bar.r);  // estimated from the mass ratio
      run.coupling.acceleration.filter = 1e-6;                         // these participants make no noise
      run.p.peak = 0.3;
      run.ratio(bar.r);
      run.p.pulse_duration = 0.2;
      run.steps(30, 0.01);
      run();
      EXPECT_EQ(run.problem, "");
      const int most = most_iterations(run);
      EXPECT_LE(most, type == Type::aitken ? bar.aitken : bar.newton) << bar.r << " type " << int(type);
      RecordProperty(fmt::format("{}_{}", std::array{"constant", "aitken", "ils"}[int(type)], bar.r),
                     fmt::format("{:.2f} {}", run.residuals.mean_iterations(), most));
    }
}

TEST(AddedMass, quasi_newton_holds_at_a_hundredth_of_the_mass) {
  ModalRun run;
  run.coupling.acceleration.type = Type::iqn_ils;
  run.p.peak = 0.3;
  run.ratio(100);
  run.p.pulse_duration = 0.2;
  run.steps(30, 0.01);
  run();
  EXPECT_EQ(run.problem, "");
  EXPECT_LE(most_iterations(run), 30);
  RecordProperty("ils_100", fmt::format("{:.2f} {}", run.residuals.mean_iterations(), most_iterations(run)));
}

/// The map of mass ratio and scheme, each limit with the neighbour that fails.
TEST(AddedMass, map_of_mass_ratio_and_scheme) {
  const AcceptedOscillation accepted;
  const auto iterations = [](double r, auto&& change) {
    ModalRun run;
    run.p.peak = 0.3;
    run.p.pulse_duration = 0.05;
    run.coupling.acceleration.initial_relaxation = 1 / (1 + r);
    run.ratio(r);
    run.steps(60, 0.005);
    change(run.coupling);
    run();
    // What grows by itself leaves the size that the push can give by far.
    const double speed = run.p.inlet_pressure * run.p.pulse_duration / run.p.surface_density;
    const bool grew = !(std::abs(run.velocities[0]) < 20 * speed);
    return run.problem.empty() && !grew ? run.residuals.mean_iterations() : -1.;
  };
  const auto explicit_of = [](int order) {
    return [order](CouplingParameters& c) { c.scheme = Scheme::explicit_, c.predictor_order = order; };
  };
  const auto of_type = [](Type type, double omega = 0) {
    return [=](CouplingParameters& c) {
      c.acceleration.type = type;
      if (omega > 0) c.acceleration.initial_relaxation = omega;
    };
  };
  for (const double r : {0.01, 0.05, 0.2, 0.3, 0.5, 0.8, 1.3, 5., 20., 50., 100.}) {
    const double rows[] = {iterations(r, explicit_of(1)), iterations(r, explicit_of(2)),
                           iterations(r, of_type(Type::constant, 1)), iterations(r, of_type(Type::aitken)),
                           iterations(r, of_type(Type::iqn_ils))};
    EXPECT_EQ(rows[0] > 0, r < 1) << "explicit, order 1, r = " << r;
    EXPECT_EQ(rows[1] > 0, r < 1. / 3) << "explicit, order 2, r = " << r;
    EXPECT_EQ(rows[2] > 0, r < 1) << "plain iteration, r = " << r;
    for (int i = 3; i < 5; ++i) EXPECT_GT(rows[i], 0) << "type " << i - 2 << ", r = " << r;
    RecordProperty(fmt::format("map_{}", r), fmt::format("{:.1f}", fmt::join(rows, " ")));
  }
}

}  // namespace couplet::added_mass_test
