// SPDX-License-Identifier: Apache-2.0
// A damped sheet is bent quickly and then left alone: short steps are needed at the start alone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "common/app/loop/step_loop.hpp"
#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::step_control_test {
using namespace time;
namespace {

constexpr double end_time = 16, longest_step = 0.4;

SolidParameters bent_sheet() {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 2e5, 0.3};
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "t < 1 ? 200*sin(1.5707963*t)^2 : 200"});
  p.damping = SolidDamping{3, 1e-3};
  return p;
}

mesh::RawMesh sheet() {
  return mesh::make_box(mesh::BoxCells::quadrilaterals, {10, 3, 1}, Vec3::Zero(), Vec3(1, 0.3, 0));
}

using Visit = std::function<void(const Solid&)>;

/// Through the loop that a program runs; gives its accepted steps and how many were refused.
std::pair<int, int> run(Solid& solid, const Visit& visit, double time_step, int max_halvings) {
  app::SimulationParameters simulation;
  simulation.end_time = end_time;
  simulation.time_step = time_step;
  simulation.max_step_halvings = max_halvings;
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("couplet-step-control-{}", ::getpid());
  app::StepLoop loop(MPI_COMM_WORLD, simulation, coupling::Scheme::standalone, folder);
  double advised = std::numeric_limits<double>::infinity();
  app::StepActions actions;
  actions.attempt = [&](const coupling::Step& step) -> std::optional<std::string> {
    try {
      solid.begin_step(step);
      solid.solve({});
      return {};
    } catch (const SolveFailure& e) {
      return e.what();
    }
  };
  actions.accept = [&](double, int) {
    solid.accept_step();
    advised = solid.suggest_dt();
    visit(solid);
  };
  actions.write_start = [](int) {};
  actions.save = [](const std::filesystem::path&) {};
  actions.report = [](const coupling::Step&, double) {};
  actions.advised_dt = [&] { return advised; };
  EXPECT_EQ(loop.run(actions), "");
  std::filesystem::remove_all(folder);
  return {int(loop.steps()), loop.halvings()};
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / double(a.size() / 2));
}

TEST(StepControl, keeps_the_error_below_the_tolerance_with_fewer_steps) {
  constexpr double tolerance = 2e-4;  // of 24 mm
  for (const TimeScheme scheme :
       {TimeScheme::trapezoidal, TimeScheme::bathe, TimeScheme::three_point, TimeScheme::generalised_alpha}) {
    SolidParameters p = bent_sheet();
    p.time_scheme.type = scheme;
    // The truth at the times that all runs share.
    std::map<int, std::vector<double>> truth;
    const auto nominal = [](double t) { return int(std::lround(t / longest_step)); };
    const auto at_nominal = [&](double t) { return std::abs(t - nominal(t) * longest_step) < 1e-9; };
    const auto exact = make_solid(sheet(), p);
    run(
        *exact,
        [&](const Solid& s) {
          if (at_nominal(s.stepper().state().time))
            truth[nominal(s.stepper().state().time)] = s.stepper().state().cell_u;
        },
        longest_step / 512, 0);

    p.step_control = TimeStepControl{tolerance};
    const auto solid = make_solid(sheet(), p);
    double worst = 0, shortest = 1, longest = 0, largest = 0;
    const auto [steps, refused] = run(
        *solid,
        [&](const Solid& s) {
          shortest = std::min(shortest, s.stepper().state().dt);
          longest = std::max(longest, s.stepper().state().dt);
          EXPECT_LE(s.stepper().state().error, 0.1 * tolerance * (1 + 1e-12));
          if (!at_nominal(s.stepper().state().time)) return;
          const auto& expected = truth.at(nominal(s.stepper().state().time));
          worst = std::max(worst, distance(s.stepper().state().cell_u, expected));
          largest = std::max(largest, distance(expected, std::vector<double>(expected.size(), 0)));
        },
        longest_step, 8);
    const int fixed = int(std::lround(end_time / shortest));
    fmt::print(
        "{}: {} steps of {:.4f} to {:.4f} s, {} refused; with the shortest {}; error {:.1e} of {:.1e} m\n",
        name(scheme), steps, shortest, longest, refused, fixed, worst, largest);
    RecordProperty(name(scheme) + "_steps", steps);
    RecordProperty(name(scheme) + "_fixed_steps", fixed);
    EXPECT_LT(worst, tolerance);
    EXPECT_LT(steps, fixed / 2);
    EXPECT_LT(shortest, longest_step / 4);
    EXPECT_GT(longest, 3 * shortest);
  }
}

}  // namespace
}  // namespace couplet::testing::step_control_test
