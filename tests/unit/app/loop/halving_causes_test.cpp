// SPDX-License-Identifier: Apache-2.0
#include "common/app/loop/step_loop.hpp"
#include "tests/support/test.hpp"

namespace couplet::halving_causes_test {
using namespace app;
using namespace coupling;

using testing::HasSubstr;

/// A run of `end` steps of 1 s whose attempts fail where `fails` says so; the problem that ended it, and its halvings.
std::pair<std::string, int> run(double end, const std::function<std::string(const Step&)>& fails) {
  SimulationParameters simulation;
  simulation.end_time = end;
  simulation.time_step = 1;
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("couplet-halving-{}", ::getpid());
  std::filesystem::create_directories(folder);
  StepLoop loop(MPI_COMM_SELF, simulation, Scheme::standalone, folder);
  StepActions actions;
  actions.attempt = [&](const Step& step) -> std::optional<StepFailure> {
    const std::string reason = fails(step);
    if (reason.empty()) return {};
    return StepFailure(reason);
  };
  actions.accept = [](double, int) {};
  actions.write_start = [](int) {};
  actions.report = [](const Step&, double) {};
  actions.save = [](const std::filesystem::path&) {};
  const std::string problem = loop.run(actions);
  std::filesystem::remove_all(folder);
  return {problem, loop.halvings()};
}

TEST(HalvingCauses, causes_are_the_same_where_only_numbers_differ) {
  const auto text = &HalvingCauses::without_numbers;
  EXPECT_EQ(text("cell 12 at (1.5e-3, -2) m has 3 faces"), text("cell 7 at (-4, 2.25) m has 6 faces"));
  EXPECT_EQ(text("grew by 1e+05 in cell 3"), "grew by # in cell #");
  EXPECT_EQ(text("did not converge"), "did not converge");
  EXPECT_NE(text("pressure: 5"), text("friction: 5"));
}

TEST(HalvingCauses, ten_for_one_cause_end_a_run_with_that_cause) {
  // Two good steps of full length after each failure: the steps grow back, and fail again.
  int good = 0;
  const auto [problem, halvings] = run(20000, [&](const Step& step) -> std::string {
    if (step.dt > 0.9 && good++ % 3 == 2) return fmt::format("energy from nothing: {} J", step.time);
    return "";
  });
  EXPECT_EQ(halvings, 10);
  EXPECT_THAT(problem,
              HasSubstr("10 halvings of the step for one cause did not help: energy from nothing: "));
}

TEST(HalvingCauses, causes_that_differ_or_come_back_after_a_calm_time_do_not) {
  int tries = 0;
  const auto rare =
      run(2000, [&](const Step&) -> std::string { return ++tries % 100 == 0 ? "a valve closes" : ""; });
  EXPECT_EQ(rare.first, "");
  EXPECT_GT(rare.second, 10);
  HalvingCauses causes;
  for (int i = 0; i < 9; ++i) {
    EXPECT_LT(causes.halved("one", 1), HalvingCauses::most);
    EXPECT_LT(causes.halved("other", 1), HalvingCauses::most);
    for (int n = 0; n < 100; ++n) causes.accepted(0.5);  // shorter than what failed: no cure
  }
  EXPECT_EQ(causes.halved("one", 1), HalvingCauses::most);
  for (int n = 0; n <= HalvingCauses::calm_steps; ++n) causes.accepted(1);
  EXPECT_EQ(causes.halved("one", 1), 1);
}

// It only feeds a run whose longer steps fail again and again.
TEST(HalvingCauses, a_run_whose_steps_never_grow_back_ends) {
  const auto [problem, halvings] =
      run(2000, [](const Step& step) { return step.dt > 0.5 ? "too long" : ""; });
  EXPECT_THAT(problem, HasSubstr("10 halvings of the step for one cause did not help: too long"));
  EXPECT_EQ(halvings, 10);
}

}  // namespace couplet::halving_causes_test
