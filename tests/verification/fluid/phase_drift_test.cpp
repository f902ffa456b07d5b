// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/diagnostics/phase_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "common/base/numbers.hpp"
#include "common/time/step_errors.hpp"

namespace couplet::testing::phase_drift_test {
namespace {

using fluid::PhaseDrift;
using fluid::Repetition;

constexpr double pi = std::numbers::pi;

bool repeats(const std::function<double(double)>& signal, double end, double dt = 0.02) {
  Repetition seen;
  for (double t = 0; t < end; t += dt) seen.add(dt, signal(t));
  return seen.repeats();
}

TEST(Repetition, of_a_swing_its_harmonics_and_cycles_of_three_maxima_is_seen_after_few_cycles) {
  EXPECT_TRUE(repeats([](double t) { return 5 + 0.01 * std::sin(2 * pi * t); }, 6));
  EXPECT_TRUE(repeats([](double t) { return std::sin(2 * pi * t) + 0.4 * std::sin(4 * pi * t + 1); }, 8));
  EXPECT_TRUE(repeats([](double t) { return std::sin(2 * pi * t) + 0.6 * std::sin(2 * pi * t / 3); }, 20));
  EXPECT_TRUE(repeats([](double t) { return 1 - std::exp(-2 * t) + 0.01 * std::sin(2 * pi * t); }, 12))
      << "after its start";
  EXPECT_TRUE(repeats([](double t) { return std::sin(2 * pi * t) + 1e-4 * std::sin(1e3 * t); }, 10, 0.001))
      << "with noise";
}

TEST(Repetition, of_what_decays_grows_rests_or_is_irregular_is_not_seen) {
  EXPECT_FALSE(repeats([](double) { return 3.; }, 20));
  EXPECT_FALSE(repeats([](double t) { return 3 + 1e-14 * std::sin(1e4 * t * t); }, 20)) << "rounding";
  EXPECT_FALSE(repeats([](double t) { return std::exp(-t); }, 20));
  EXPECT_FALSE(repeats([](double t) { return 1 + std::exp(-0.3 * t) * std::sin(2 * pi * t); }, 6))
      << "decays";
  EXPECT_FALSE(repeats([](double t) { return 1 + std::exp(0.3 * t) * std::sin(2 * pi * t); }, 10)) << "grows";
  EXPECT_FALSE(repeats([](double t) { return std::sin(6 * pi * std::log(1 + t)); }, 30))
      << "slower and slower";
  EXPECT_FALSE(
      repeats([](double t) { return std::sin(2 * pi * t) + std::sin(2 * pi * std::numbers::sqrt2 * t); }, 30))
      << "two frequencies";
  double x = 0.3;
  EXPECT_FALSE(repeats(
      [&](double t) {
        return (x += 2e-4 * std::sin(37 * t) * x * (1 - x),
                std::sin(2 * pi * t) * (1 + std::sin(5.3 * t * t)));
      },
      30))
      << "irregular";
}

/// u' = i omega u by Adams and Bashforth: the error after `periods`, what the drift is estimated at, and what errors that are forgotten within
/// two periods would leave.
struct Swing {
  double truth = 0, drift = 0, forgotten = 0, size = 0;
};
Swing swing(int periods, int steps_a_period) {
  const double dt = 1. / steps_a_period, omega = 2 * pi;
  const std::complex<double> law(0, omega);
  std::complex<double> u(1, 0), before = law * std::polar(1., -omega * dt);
  PhaseDrift drift;
  time::StepErrors steps;
  for (int k = 0; k < periods * steps_a_period; ++k) {
    const std::complex<double> rate = law * u;
    u += dt * (1.5 * rate - 0.5 * before), before = rate;
    const double size = std::abs(u);
    drift.add(dt, u.real() * u.real(), omega * size, omega * omega * size, 5. / 12 * dt * dt);
    steps.add({.error = 5. / 12 * std::pow(omega * dt, 3) * size,
               .rate = omega * size,
               .size = size,
               .dt = dt,
               .forgotten = 0.5});
  }
  const double truth = std::abs(u - std::polar(1., omega * dt * periods * steps_a_period));
  return {truth, drift.error(), steps.over_size(), std::abs(u)};
}

TEST(PhaseDrift, of_a_swing_is_its_error_over_many_periods_where_what_is_forgotten_is_not) {
  for (int periods : {4, 30, 100, 300}) {
    const Swing s = swing(periods, 200);
    EXPECT_NEAR(s.drift / s.truth, 1, 0.1) << periods;
  }
  const Swing late = swing(100, 200);
  EXPECT_LT(late.forgotten, late.truth / 3) << "the neighbour: a sum that forgets";
}

TEST(PhaseDrift, is_at_most_twice_the_amplitude) {
  const Swing s = swing(3000, 200);  // 2.6e-3 rad a period: long out of step
  EXPECT_NEAR(s.drift / s.size, 2, 0.2);
}

TEST(PhaseDrift, of_a_run_that_stops_and_goes_on_is_that_of_one_run) {
  PhaseDrift whole, second;
  for (int k = 0; k < 900; ++k) {
    const double e = std::sin(0.1 * k);
    if (k == 450) base::from_numbers(base::to_numbers(whole), second, "drift");
    whole.add(0.01, e, 1, 10, 1e-4);
    if (k >= 450) second.add(0.01, e, 1, 10, 1e-4);
  }
  EXPECT_GT(whole.error(), 0);
  EXPECT_EQ(whole.error(), second.error());
  EXPECT_EQ(base::to_numbers(whole), base::to_numbers(second));
}

}  // namespace
}  // namespace couplet::testing::phase_drift_test
