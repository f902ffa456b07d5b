// SPDX-License-Identifier: Apache-2.0
#include "common/app/supervision/supervisor.hpp"
#include "tests/support/test.hpp"

namespace couplet::supervisor_test {
using namespace std::chrono_literals;

TEST(StartGuardDeathTest, ends_a_start_that_takes_too_long) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        app::StartDeadline guard(0.05, "fluid");
        std::this_thread::sleep_for(30s);
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(1), "\\[fluid\\] error: .* have answered within 0.05 s");
}

TEST(StartGuardDeathTest, is_silent_once_disarmed_and_where_no_timeout_is_asked_for) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        std::optional<app::StartDeadline> guard(std::in_place, 0.05, "fluid");
        const app::StartDeadline never(0, "solid");
        guard.reset();
        std::this_thread::sleep_for(300ms);
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(0), "^$");
}

}  // namespace couplet::supervisor_test
