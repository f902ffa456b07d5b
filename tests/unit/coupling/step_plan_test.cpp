// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/step_plan.hpp"
#include "tests/support/test.hpp"

namespace couplet::step_plan_test {
using namespace coupling;

TEST(StepPlan, nominal_steps_end_at_the_end) {
  StepPlan plan(1, 0.1, 6);
  int n = 0;
  for (; !plan.finished(); ++n) {
    EXPECT_EQ(plan.dt(), 0.1) << "exactly, so that factorised matrices are found again";
    EXPECT_NEAR(plan.time(), 0.1 * n, 1e-15);
    plan.accepted();
    EXPECT_TRUE(plan.at_nominal_time());
  }
  EXPECT_EQ(n, 10);
  EXPECT_EQ(plan.time(), 1);
}

TEST(StepPlan, last_step_is_shortened_to_the_end_time) {
  StepPlan plan(0.25, 0.1, 6);
  std::vector<double> dt;
  for (; !plan.finished(); plan.accepted()) {
    dt.push_back(plan.dt());
    EXPECT_EQ(plan.is_last(), dt.size() == 3);
  }
  ASSERT_EQ(dt.size(), 3u);
  EXPECT_NEAR(dt[2], 0.05, 1e-15);
  EXPECT_EQ(plan.time(), 0.25);
}

TEST(StepPlan, last_step_takes_along_what_the_digits_of_the_step_leave) {
  StepPlan plan(8, 0.033333333333, 6);
  double sum = 0, least = 1;
  int n = 0;
  for (; !plan.finished(); ++n) {
    sum += plan.dt();
    least = std::min(least, plan.dt());
    plan.accepted();
  }
  EXPECT_EQ(n, 240);
  EXPECT_EQ(least, 0.033333333333);
  EXPECT_NEAR(sum, 8, 1e-13);
  EXPECT_EQ(plan.time(), 8);
}

TEST(StepPlan, more_steps_than_an_int_can_count) {
  const double n = 3e9;
  StepPlan plan(n * 0.1, 0.1, 6);
  EXPECT_FALSE(plan.finished());
  EXPECT_EQ(plan.dt(), 0.1);
  plan.restore({n - 2, 0, 0, 0, n - 2, 2}, (n - 2) * 0.1);
  int left = 0;
  for (; !plan.finished(); ++left) {
    ASSERT_LT(left, 4);
    EXPECT_EQ(plan.is_last(), left == 1);
    plan.accepted();
  }
  EXPECT_EQ(left, 2);
  EXPECT_EQ(plan.steps_accepted(), 3'000'000'000);
  EXPECT_EQ(plan.time(), n * 0.1);
}

TEST(StepPlan, refuses_what_cannot_be_counted) {
  EXPECT_NO_THROW(StepPlan(1, 1e-12, 0));
  EXPECT_THROW(StepPlan(1, 1e-13, 0), Error);
  EXPECT_THROW(StepPlan(1e300, 1e-300, 0), Error) << "infinitely many";
}

TEST(StepPlan, last_step_is_known_when_steps_are_halved) {
  StepPlan plan(0.2, 0.1, 6);
  plan.accepted();
  ASSERT_TRUE(plan.halve());
  EXPECT_FALSE(plan.is_last()) << "two halves are left";
  plan.accepted();
  EXPECT_TRUE(plan.is_last());
  plan.accepted();
  EXPECT_TRUE(plan.finished());
}

TEST(StepPlan, halves_grow_back_and_meet_the_nominal_times) {
  StepPlan plan(1, 0.1, 6);
  plan.accepted();
  ASSERT_TRUE(plan.halve());
  ASSERT_TRUE(plan.halve());
  EXPECT_EQ(plan.dt(), 0.025);
  std::vector<double> dt;
  std::set<int> nominal;
  double t = plan.time();
  for (; !plan.finished(); plan.accepted()) {
    EXPECT_NEAR(plan.time(), t, 1e-15);
    if (plan.at_nominal_time()) nominal.insert(int(std::lround(t / 0.1)));
    dt.push_back(plan.dt());
    t += plan.dt();
  }
  EXPECT_EQ(nominal.size(), 9u) << "all nominal times from 0.1 to 0.9 were met";
  EXPECT_EQ(dt.front(), 0.025);
  EXPECT_EQ(dt.back(), 0.1);
  EXPECT_NEAR(t, 1, 1e-14);
}

TEST(StepPlan, grows_back_later_each_time_that_was_too_early) {
  StepPlan plan(10, 0.1, 6);
  int attempts = 0;
  for (; !plan.finished(); ++attempts) {
    if (plan.dt() > 0.06)
      plan.halve();
    else
      plan.accepted();
  }
  EXPECT_EQ(plan.steps_accepted(), 200);
  EXPECT_LT(attempts - plan.steps_accepted(), 10) << "failed attempts at a step that is always too long";
}

TEST(StepPlan, halving_stops_at_the_limit) {
  StepPlan plan(1, 0.1, 2);
  EXPECT_TRUE(plan.halve());
  EXPECT_TRUE(plan.halve());
  EXPECT_FALSE(plan.halve());
  EXPECT_EQ(plan.dt(), 0.025);
}

TEST(StepPlan, a_rest_that_rounding_parts_from_half_a_step_is_that_half) {
  StepPlan plan(2.9, 0.2, 6);  // 2.9 - 14 * 0.2 is not 0.1
  ASSERT_NE(2.9 - 14 * 0.2, 0.1);
  while (!plan.is_last()) plan.accepted();
  EXPECT_EQ(plan.dt(), 0.1);
  plan.accepted();
  EXPECT_EQ(plan.time(), 2.9);
  StepPlan odd(2.93, 0.2, 6);
  while (!odd.is_last()) odd.accepted();
  EXPECT_EQ(odd.dt(), 2.93 - 14 * 0.2);
}

TEST(StepPlan, obeys_advice) {
  StepPlan plan(1, 0.1, 6);
  plan.limit(0.03);
  EXPECT_EQ(plan.dt(), 0.025);
  plan.accepted();
  plan.limit(1);
  EXPECT_EQ(plan.dt(), 0.025) << "a longer step would not end at a nominal time";
}

TEST(StepPlan, continues_from_its_state) {
  StepPlan plan(1, 0.1, 6);
  plan.accepted();
  plan.halve();
  plan.accepted();
  StepPlan other(1, 0.1, 6);
  other.restore(plan.state(), plan.time());
  for (; !plan.finished(); plan.accepted(), other.accepted()) {
    EXPECT_EQ(plan.time(), other.time());
    EXPECT_EQ(plan.dt(), other.dt());
  }
  EXPECT_TRUE(other.finished());
}

TEST(StepPlan, continues_with_another_nominal_step_that_divides_the_time) {
  StepPlan plan(1, 0.1, 6);
  for (int i = 0; i < 4; ++i) plan.accepted();
  StepPlan other(1, 0.05, 6);
  other.restore(plan.state(), plan.time());
  EXPECT_NEAR(other.time(), 0.4, 1e-15);
  StepPlan wrong(1, 0.3, 6);
  EXPECT_THROW(wrong.restore(plan.state(), plan.time()), Error);
}

}  // namespace couplet::step_plan_test
