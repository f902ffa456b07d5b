// SPDX-License-Identifier: Apache-2.0
// What schemes make of an oscillator in a step, against the roots of their recursions.
#include "common/time/time_scheme.hpp"
#include "tests/support/test.hpp"

namespace couplet::amplification_test {
using namespace time;

using Complex = std::complex<double>;

struct Oscillator {
  Complex eigenvalue;
  RayleighCoefficients damping;
  double dt;
};

const Oscillator oscillators[] = {{{25, 0}, {0, 0}, 0.05},   {{25, 0}, {1.5, 0}, 0.05},
                                  {{25, 0}, {0, 0.02}, 0.1}, {{25, 0}, {0.4, 0.03}, 0.02},
                                  {{9, 2}, {0.1, 0}, 0.1},   {{-4, 0}, {0.2, 0}, 0.05}};

/// The larger of the two by |z(s)|, s the roots of s^2 + (alpha + beta lambda) s + lambda = 0.
template <class F>
double largest(const Oscillator& o, const F& z) {
  const Complex half = -0.5 * (o.damping.mass + o.eigenvalue * o.damping.stiffness),
                root = std::sqrt(half * half - o.eigenvalue);
  return std::max(z((half + root) * o.dt), z((half - root) * o.dt));
}

double got(const Oscillator& o, TimeScheme type) {
  return amplification({type, 0.8}, o.dt, o.eigenvalue, o.damping);
}

TEST(Amplification, of_the_trapezoidal_rule_and_of_euler_are_those_of_their_rational_functions) {
  for (const Oscillator& o : oscillators) {
    EXPECT_NEAR(got(o, TimeScheme::trapezoidal),
                largest(o, [](Complex s) { return std::abs((1. + s / 2.) / (1. - s / 2.)); }), 1e-9);
    EXPECT_NEAR(got(o, TimeScheme::euler), largest(o, [](Complex s) { return std::abs(1. / (1. - s)); }),
                1e-9);
  }
}

// (3/2 - s) z^2 - 2 z + 1/2 = 0
TEST(Amplification, of_the_three_point_scheme_is_the_root_of_its_recursion) {
  for (const Oscillator& o : oscillators)
    EXPECT_NEAR(got(o, TimeScheme::three_point),
                largest(o,
                        [](Complex s) {
                          const Complex a = 1.5 - s, root = std::sqrt(1. - a * 0.5);
                          return std::max(std::abs((1. + root) / a), std::abs((1. - root) / a));
                        }),
                1e-9);
}

// A trapezoidal step over g dt, then a three-point one over the rest: the product of their functions.
TEST(Amplification, of_bathe_is_that_of_its_two_parts) {
  const double g = 2 - std::sqrt(2.);
  for (const Oscillator& o : oscillators)
    EXPECT_NEAR(got(o, TimeScheme::bathe),
                largest(o,
                        [&](Complex s) {
                          const Complex half = (1. + g * s / 2.) / (1. - g * s / 2.);
                          // u' = c3 u_2 + c2 u_1 + c1 u_0 over 1 - g after g
                          const double a = 1 - g, c1 = a / g, c2 = -1 / (a * g), c3 = 1 / a + 1;
                          return std::abs((-c2 * half - c1) / (c3 - s));
                        }),
                1e-9);
}

TEST(Amplification, of_generalised_alpha_is_its_radius_where_steps_are_long_and_no_growth_ever) {
  for (const double radius : {0.2, 0.5, 0.9}) {
    const TimeSchemeParameters scheme{TimeScheme::generalised_alpha, radius};
    EXPECT_NEAR(amplification(scheme, 1, 1e12, {0, 0}), radius, 1e-3);  // a double root
    for (const double lambda : {1e-2, 1., 1e2, 1e4}) {
      EXPECT_LE(amplification(scheme, 1, lambda, {0, 0}), 1 + 1e-9);
      EXPECT_LT(amplification(scheme, 1, lambda, {0.3, 0}), amplification(scheme, 1, lambda, {0, 0}));
    }
  }
}

TEST(Amplification, growth_is_its_logarithm_a_second_and_that_of_the_motion_itself) {
  const Oscillator& o = oscillators[1];
  EXPECT_NEAR(growth_rate({TimeScheme::trapezoidal, 0.8}, o.dt, o.eigenvalue, o.damping), -0.75, 2e-2);
  EXPECT_NEAR(growth_rate({-4, 0}), 2, 1e-12);
  EXPECT_NEAR(growth_rate({9, 0}), 0, 1e-12);
}

}  // namespace couplet::amplification_test
