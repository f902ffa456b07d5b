// SPDX-License-Identifier: Apache-2.0
#include "coupler/predictor.hpp"

#include <gtest/gtest.h>

namespace couplet {
namespace {

/// Motion with velocity v(t) = 2 + 3 t and displacement 2 t + 1.5 t^2, known at t = 1 and, with a step of
/// 0.4, before.
InterfaceHistory accelerated_motion() { return {{{3.5}, {5.}}, {2 + 3 * 0.6}, 0.4}; }

TEST(Predictor, order_0_repeats_the_last_state) {
  const auto guess = predict(accelerated_motion(), 0.2, 0);
  EXPECT_EQ(guess.displacement[0], 3.5);
  EXPECT_EQ(guess.velocity[0], 5);
}

TEST(Predictor, order_1_goes_on_with_the_last_velocity) {
  const auto guess = predict(accelerated_motion(), 0.2, 1);
  EXPECT_DOUBLE_EQ(guess.displacement[0], 3.5 + 0.2 * 5);
  EXPECT_EQ(guess.velocity[0], 5);
}

TEST(Predictor, order_2_is_exact_for_constant_acceleration_also_when_the_step_changes) {
  for (const double dt : {0.1, 0.4, 1.}) {
    const auto guess = predict(accelerated_motion(), dt, 2);
    const double t = 1 + dt;
    EXPECT_NEAR(guess.displacement[0], 2 * t + 1.5 * t * t, 1e-14) << dt;
    EXPECT_NEAR(guess.velocity[0], 2 + 3 * t, 1e-14) << dt;
  }
}

TEST(Predictor, first_step_of_order_2_is_of_order_1) {
  InterfaceHistory history = accelerated_motion();
  history.old_velocity.clear();
  history.old_dt = 0;
  const auto guess = predict(history, 0.2, 2);
  EXPECT_DOUBLE_EQ(guess.displacement[0], 4.5);
  EXPECT_EQ(guess.velocity[0], 5);
}

}  // namespace
}  // namespace couplet
