// SPDX-License-Identifier: Apache-2.0
#include "common/time/step_errors.hpp"

#include <numbers>

#include "tests/support/test.hpp"

namespace couplet::step_errors_test {
using namespace time;

TEST(StepErrorsTest, errors_of_an_oscillation_add_up) {
  StepErrors errors;
  const double dt = 0.1;
  for (int n = 1; n <= 1000; ++n)
    errors.add({1e-5, std::abs(std::cos(n * dt)), std::abs(std::sin(n * dt)), dt});
  // The size of late has faded by 4 % since its last maximum.
  EXPECT_NEAR(errors.over_size(), 1.04 * 1000 * 1e-5, 2e-4);
}

TEST(StepErrorsTest, on_the_way_to_a_steady_state_they_are_forgotten) {
  StepErrors errors;  // u = 1 - exp(-t), error of a step 1e-3 exp(-t)
  const double dt = 0.1;
  for (int n = 1; n <= 400; ++n)
    errors.add({1e-3 * std::exp(-n * dt), std::exp(-n * dt), 1 - std::exp(-n * dt), dt});
  EXPECT_LT(errors.over_size(), 1e-3);  // their plain sum is 1e-2
}

TEST(StepErrorsTest, of_a_decay_they_decay_as_it_does) {
  StepErrors errors;  // u = exp(-t), each step leaves 1e-4 u
  const double dt = 0.01;
  for (int n = 1; n <= 300; ++n)
    errors.add({1e-4 * std::exp(-n * dt), std::exp(-n * dt), std::exp(-n * dt), dt});
  // Exactly 300 * 1e-4 of u; sizes of late and rates by powers of two blur it.
  EXPECT_GT(errors.over_size(), 0.5 * 0.03);
  EXPECT_LT(errors.over_size(), 2 * 0.03);
}

TEST(StepErrorsTest, of_a_damped_motion_that_loads_keep_going_old_ones_are_forgotten) {
  StepErrors damped,
      undamped;  // u = sin(t) for ever; errors die at 0.5 1/s: 1e-5 / (1 - exp(-0.05)) are left
  const double dt = 0.1;
  for (int n = 1; n <= 5000; ++n) {
    StepErrors::Inputs seen{
        .error = 1e-5, .rate = std::abs(std::cos(n * dt)), .size = std::abs(std::sin(n * dt)), .dt = dt};
    undamped.add(seen);
    seen.forgotten = 0.5;
    damped.add(seen);
  }
  EXPECT_NEAR(undamped.over_size(), 5000 * 1e-5, 5e-3);
  EXPECT_NEAR(damped.over_size(), 1e-5 / (1 - std::exp(-0.05)), 3e-5);
}

TEST(StepErrorsTest, ringing_that_steps_do_not_resolve_errs_by_no_more_than_twice_itself) {
  // u = sin(t) + 0.001 sin(50 t): errors dt^3 / 12 d3u/dt3 of the ringing would add up to 1000 times its size.
  const double dt = 0.05, w = 50, a = 1e-3;
  StepErrors errors;
  for (int n = 1; n <= 2000; ++n) {
    const double t = n * dt, third = std::abs(std::cos(t) + a * w * w * w * std::cos(w * t));
    const double second = std::abs(std::sin(t) + a * w * w * std::sin(w * t));
    errors.add(
        {dt * dt * dt / 12 * third, std::abs(std::cos(t)), std::abs(std::sin(t)), dt, 2, second, third});
  }
  EXPECT_LT(errors.over_size(), 0.02);
  StepErrors alone;  // w = 1 alone: phase 100 dt^2 / 12 = 0.021, times the mean of |cos|
  for (int n = 1; n <= 2000; ++n) {
    const double t = n * dt, third = std::abs(std::cos(t));
    alone.add({dt * dt * dt / 12 * third, third, std::abs(std::sin(t)), dt, 2, std::abs(std::sin(t)), third});
  }
  EXPECT_NEAR(alone.over_size(), 0.0208 * 2 / std::numbers::pi, 2e-3);
}

TEST(StepErrorsTest, nothing_is_known_before_the_first_step) {
  EXPECT_TRUE(std::isnan(StepErrors().over_size()));
  StepErrors errors;
  errors.restore(std::vector<double>{});
  EXPECT_TRUE(std::isnan(errors.over_size()));
}

TEST(StepErrorsTest, swings_of_an_oscillation_are_counted_and_a_decay_is_none) {
  StepErrors swing, decay;
  for (int n = 0; n < 1000; ++n) {
    const double t = 0.02 * n;  // 10 periods of 2 s
    swing.add({.error = 1e-6,
               .rate = std::abs(std::numbers::pi * std::cos(std::numbers::pi * t)),
               .size = std::abs(std::sin(std::numbers::pi * t)),
               .dt = 0.02});
    decay.add({.error = 1e-6, .rate = std::exp(-t), .size = 1 + std::exp(-t), .dt = 0.02});
  }
  EXPECT_NEAR(swing.swings(), 10, 0.1);
  EXPECT_LT(decay.swings(), 0.5);
}

TEST(StepErrorsTest, a_restart_goes_on_bit_for_bit_and_a_damaged_state_is_refused) {
  StepErrors whole, first, second;
  for (int n = 1; n <= 20; ++n) {
    StepErrors& part = n <= 10 ? first : second;
    if (n == 11) second.restore(first.state());
    for (StepErrors* e : {&whole, &part}) e->add({1e-3 / n, 1. / n, 2, 0.1, 2, 3. / n, 8. / n});
  }
  EXPECT_EQ(whole.over_size(), second.over_size());
  EXPECT_EQ(whole.state(), second.state());
  EXPECT_THROW(second.restore(std::vector<double>{1, 2}), Error);
  // Numbers that say how many follow, or what they belong to, may be anything.
  for (std::size_t i = 5; i < whole.state().size(); ++i)
    for (const double odd : {-1., 0.5, 1e18, double(NAN)}) {
      std::vector<double> state = whole.state();
      state[i] = odd;
      try {
        second.restore(state);
        second.over_size();
      } catch (const Error&) {
        continue;
      }
    }
  std::vector<double> state = whole.state();
  state[5] = 1e18;
  EXPECT_THROW(second.restore(state), Error);
}

}  // namespace couplet::step_errors_test
