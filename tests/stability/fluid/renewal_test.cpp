// SPDX-License-Identifier: Apache-2.0
// Predictions made anew: a wall whose every pass is solved exactly but for a mass that acts on the guess.
#include "fluid_solver/step/renewal.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace couplet::fluid::test::renewal_test {
namespace {

constexpr double load = 1;  // N, beside which what friction misses is judged

/// M (w - w^n) + E (g - w^n) = push, dt = 1 s; a pass leaves the share `added`/M of what is missing.
struct Wall {
  double mass, layer, added = 0.3, now = 0, before = 0;
  int renewals = 0;
  Renewal<2> renewal = {};

  double answer(double guess, double push) const { return now + (push - layer * (guess - now)) / mass; }
  /// `most`: renewals a step.
  void step(double push, int most) {
    double guess = 2 * now - before, w = guess;
    renewal.start({Vec<2>(0, guess)});
    for (int pass = 2; pass <= 40; ++pass) {
      const double goal = answer(guess, push);
      w = goal + added / mass * (w - goal);
      if (renewal.count() == most) continue;
      if (renewal.wanted(MPI_COMM_SELF, {Vec<2>(0, w)}, layer * std::abs(w - guess) / load))
        guess = renewal.guess()[0].y();
    }
    renewals += renewal.count();
    before = now;
    now = w;
  }
};

/// Change of the velocity in the last of 60 steps of a wall pushed in the first three.
double left_over(Wall& wall, int most = 100) {
  for (int n = 0; n < 60; ++n) wall.step(n < 3 ? 0.1 * load : 0, most);
  return std::abs(wall.now - wall.before);
}

TEST(Renewal, holds_a_wall_of_less_mass_than_the_layer_that_it_drags) {
  Wall light{1, 1.5}, equal{1, 0.9};
  EXPECT_LT(left_over(light), 2e-3);
  EXPECT_LT(left_over(equal), 2e-3);
  EXPECT_GT(light.renewals, 10);
}

// The neighbour: friction at the guessed velocity alone, or with one better guess.
TEST(Renewal, such_a_wall_grows_without_it_and_with_one_only) {
  Wall never{1, 1.5}, once{1, 1.5};
  EXPECT_GT(left_over(never, 0), 1e3);
  EXPECT_GT(left_over(once, 1), 1e3);
}

TEST(Renewal, leaves_a_heavy_wall_alone_whatever_its_guess_misses) {
  Wall heavy{100, 20};
  left_over(heavy);
  EXPECT_EQ(heavy.renewals, 0);
  Wall lighter{100, 20, 30};
  left_over(lighter);
  EXPECT_GT(lighter.renewals, 0);
}

TEST(Renewal, waits_for_a_better_velocity_than_a_relaxed_pass_has) {
  const auto at = [](double w) { return Vectors<2>{Vec<2>(w, 0)}; };
  Renewal<2> renewal;
  renewal.start(at(0));
  EXPECT_FALSE(renewal.wanted(MPI_COMM_SELF, at(0.8), 0.01)) << "second pass";
  EXPECT_FALSE(Renewal<2>(renewal).wanted(MPI_COMM_SELF, at(1), 1e-4)) << "nothing is missed";
  EXPECT_FALSE(Renewal<2>(renewal).wanted(MPI_COMM_SELF, at(0.801), 0.01)) << "heavy: passes converge fast";
  EXPECT_TRUE(renewal.wanted(MPI_COMM_SELF, at(1), 0.01));
  Renewal<2> shrinking = renewal;
  EXPECT_FALSE(renewal.wanted(MPI_COMM_SELF, at(1.9), 1)) << "the gap of 1 became 0.9";
  EXPECT_TRUE(renewal.wanted(MPI_COMM_SELF, at(1.9), 1));
  EXPECT_TRUE(shrinking.wanted(MPI_COMM_SELF, at(1.5), 1)) << "the gap of 1 became 0.5";
}

}  // namespace
}  // namespace couplet::fluid::test::renewal_test
