// SPDX-License-Identifier: Apache-2.0
// The constants by which errors of a step are estimated, against the errors that the stages make.
#include "common/time/time_scheme.hpp"
#include "tests/support/test.hpp"

namespace couplet::error_constants_test {
using namespace time;

double of(const Levels& l, double x, double u, double u_old) { return l.x * x + l.u * u + l.u_old * u_old; }

/// u' = u from u = 1 over `steps` steps of dt; the level before the start is exact.
double grown(const TimeSchemeParameters& scheme, double dt, int steps) {
  double u = 1, before = std::exp(-dt);
  for (int n = 0; n < steps; ++n) {
    const double start = u;
    double old = before;
    for (const Stage& s : second_order_stages(scheme, dt, {n + 1, dt})) {
      if (s.start > 0) old = start;
      const double x = -of(s.rate, 0, u, old) / (s.rate.x - 1);
      u = of(s.end_value, x, u, old);
    }
    before = start;
  }
  return u;
}

// Errors C dt^(p+1) u^(p+1) of N steps add up to C dt^p T u.
TEST(ErrorConstants, are_those_of_the_stages_for_a_growing_value) {
  for (const TimeScheme type :
       {TimeScheme::euler, TimeScheme::three_point, TimeScheme::trapezoidal, TimeScheme::bathe}) {
    const TimeSchemeParameters scheme{type, 0.8};
    const LocalError error = local_error(scheme);
    const double dt = 1e-3;
    const int steps = 2000;
    const double relative = grown(scheme, dt, steps) / std::exp(dt * steps) - 1;
    const double measured = std::abs(relative) / (std::pow(dt, error.order) * dt * steps);
    EXPECT_NEAR(measured / std::abs(error.constant), 1, 0.01) << name(type);
  }
}

// What is exact after one step, the acceleration at its start, is not after many: the displacement of a single step errs by more.
TEST(ErrorConstants, of_generalised_alpha_is_that_of_the_frequency) {
  for (const double radius : {0.3, 0.8, 1.0}) {
    const TimeSchemeParameters scheme{TimeScheme::generalised_alpha, radius};
    const double dt = 0.02;
    const int steps = 10000;
    double u = 1, v = 0, a = -1, angle = 0, last = 0;
    for (int k = 0; k < steps; ++k) {
      const Stage s = second_order_stages(scheme, dt, {3, dt}).at(0);
      // u'' + u = 0 at the unknown x: every level is a combination of x and the values at the start.
      const auto of = [&](const Levels& l, double x) { return l.x * x + l.u * u + l.v * v + l.a * a; };
      const double x = -of(s.acceleration, 0) / (1 + s.acceleration.x);
      const double now[] = {of(s.end_value, x), of(s.end_rate, x), of(s.end_acceleration, x)};
      u = now[0], v = now[1], a = now[2];
      const double next = std::atan2(-v, u);
      angle += std::remainder(next - last, 2 * std::numbers::pi);
      last = next;
    }
    const double lag = 1 - angle / (dt * steps);
    EXPECT_NEAR(lag / (dt * dt) / local_error(scheme).constant, 1, 0.02) << radius;
  }
}

// Rates are exact for the powers of time that their order promises, on steps of any ratio.
TEST(ErrorConstants, rates_and_accelerations_are_exact_for_parabolas) {
  const double dt = 0.3, dt_old = 0.2, t = 1.1;
  const auto u = [](double s) { return 2 + 3 * s - 4 * s * s; };
  const auto v = [](double s) { return 3 - 8 * s; };
  for (const TimeScheme type :
       {TimeScheme::three_point, TimeScheme::trapezoidal, TimeScheme::bathe, TimeScheme::generalised_alpha}) {
    Levels old{0, u(t), v(t), -8, u(t - dt_old), v(t - dt_old)};
    const double start_u = old.u, start_v = old.v;
    const auto value = [&](const Levels& l, double x) {
      return l.x * x + l.u * old.u + l.v * old.v + l.a * old.a + l.u_old * old.u_old + l.v_old * old.v_old;
    };
    for (const Stage& s : second_order_stages({type, 0.7}, dt, {3, dt_old})) {
      if (s.start > 0) old.u_old = start_u, old.v_old = start_v;
      const double end = t + s.start + s.dt;
      // The unknown whose end is the parabola's.
      const double x = (u(end) - value(s.end_value, 0)) / s.end_value.x;
      EXPECT_NEAR(value(s.end_rate, x), v(end), 1e-12) << name(type);
      EXPECT_NEAR(value(s.rate, x), v(t + s.start + s.place * s.dt), 1e-12) << name(type);
      EXPECT_NEAR(value(s.acceleration, x), -8, 1e-11) << name(type);
      EXPECT_NEAR(value(s.end_acceleration, x), -8, 1e-11) << name(type);
      old.u = u(end), old.v = v(end), old.a = -8;
    }
  }
}

}  // namespace couplet::error_constants_test
