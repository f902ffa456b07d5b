// SPDX-License-Identifier: Apache-2.0
// Steps far below and far above what the cells ask for. Mechanism: a scheme without damping keeps what the operator makes, and
// an operator that is not symmetric makes energy on leaning cells, a little each step; a damping scheme must not make any where
// the step resolves nothing. Here over thousands of steps; 1e5 and 1e4 of them are rows of `scripts/validate stability`.
#include <gtest/gtest.h>

#include "swing.hpp"

namespace couplet::testing::slow_and_fast_test {
using namespace time;
namespace {

/// Step at an elastic Courant number: cells of 0.1 m, E = 1e5 Pa, 1000 kg/m^3.
double step_at(double courant) {
  const double lambda = 0.3e5 / (1.3 * 0.4), mu = 1e5 / 2.6;
  return courant * 0.1 / std::sqrt((lambda + 2 * mu) / 1000);
}

Swing swing_at(double courant, TimeScheme scheme, FaceGradient gradient, int steps) {
  return swing(sheet(0.5), free_swing(scheme, gradient), {step_at(courant)}, steps);
}

TEST(SlowSwings, at_a_courant_number_of_a_hundredth_keep_their_energy_with_the_symmetric_gradient) {
  const Swing s = swing_at(0.01, TimeScheme::trapezoidal, FaceGradient::symmetric, 4000);
  EXPECT_FALSE(s.ended) << s.cause;
  EXPECT_LT(s.growth, 1e-7);
}

// The neighbour: on the same leaning cells at the same time of 40 crossings of a cell.
TEST(SlowSwings, grow_with_the_trapezoidal_rule_and_the_corrected_gradient) {
  const Swing s = swing_at(0.1, TimeScheme::trapezoidal, FaceGradient::corrected, 4000);
  fmt::print("corrected: {:.3g} {}\n", s.growth, s.cause);
  EXPECT_GT(s.growth, 1e-3);
}

// After some 180 steps the motion has died away to 1e-150, where norms underflow: no failure of the solver.
TEST(FastSwings, at_a_courant_number_of_a_thousand_do_not_grow_with_bathes_scheme) {
  for (const FaceGradient gradient :
       {FaceGradient::symmetric, FaceGradient::corrected, FaceGradient::thesis}) {
    SolidParameters p = free_swing(TimeScheme::bathe, gradient);
    p.method.relative_tolerance = 1e-10;
    const Swing s = swing(sheet(0.5), p, {step_at(1000)}, 400);
    EXPECT_FALSE(s.ended) << s.cause;
    EXPECT_LT(s.growth, 1e-3);
  }
}

// The neighbour: the trapezoidal rule keeps all of what an operator without symmetry makes, also of what it does not resolve
// (at 1000 too little for a test: a swing that is turned round in each step feels next to nothing of the operator).
TEST(FastSwings, at_a_courant_number_of_ten_grow_with_the_trapezoidal_rule_and_the_thesiss_gradient) {
  for (const TimeScheme scheme : {TimeScheme::trapezoidal, TimeScheme::bathe}) {
    SolidParameters p = free_swing(scheme, FaceGradient::thesis);
    p.method.relative_tolerance = 1e-10;
    const Swing s = swing(sheet(0.5), p, {step_at(10)}, 4000);
    EXPECT_EQ(s.ended, scheme == TimeScheme::trapezoidal) << s.cause;
    EXPECT_EQ(s.growth > 1e-3, scheme == TimeScheme::trapezoidal) << s.growth;
  }
}

}  // namespace
}  // namespace couplet::testing::slow_and_fast_test
