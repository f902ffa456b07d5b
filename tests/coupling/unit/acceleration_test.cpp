// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "coupler/fixed_point.hpp"

namespace couplet {
namespace {

using Vector = std::vector<double>;

/// H(x) = A x + b with A = diag(slopes); its fixed point is b / (1 - slope). Velocity: the same in other
/// units.
FixedPointMap linear_map(const Vector& slopes, const Vector& b) {
  return [=](const InterfaceState& x) {
    InterfaceState image = x;
    for (std::size_t i = 0; i < b.size(); ++i) {
      image.displacement[i] = slopes[i] * x.displacement[i] + b[i];
      image.velocity[i] = 10 * image.displacement[i];
    }
    return image;
  };
}

const IterationObserver nobody = [](int, const Residual&, double) {};

FixedPointResult solve(const FixedPointMap& map, std::size_t n, Acceleration& acceleration,
                       double tolerance = 1e-10, int most = 200) {
  ConvergenceParameters parameters;
  parameters.relative = tolerance;
  parameters.max_iterations = most;
  return solve_fixed_point({Vector(n, 0.), Vector(n, 0.)}, 1, map, parameters, acceleration, nobody);
}

TEST(Aitken, factor_is_exact_for_a_scalar_linear_map) {
  // r = b - (1 - a) x: the best factor is 1 / (1 - a), whatever factor led from x to the next x.
  const double a = -4, b = 3, x = 0.5, omega = 0.3;
  const double r = b - (1 - a) * x;
  const double next = b - (1 - a) * (x + omega * r);
  EXPECT_NEAR(aitken_factor(omega, Vector{r}, Vector{next}), 1 / (1 - a), 1e-14);
}

TEST(Aitken, follows_the_erratum_of_equation_4_23_for_vectors) {
  const Vector r{1, 2, -1}, next{0.5, -1, 0.25};
  // change = (-0.5, -3, 1.25): r . change = -7.75, |change|^2 = 10.8125
  EXPECT_NEAR(aitken_factor(0.4, r, next), 0.4 * 7.75 / 10.8125, 1e-15);
}

TEST(Aitken, keeps_its_factor_if_the_residual_does_not_change) {
  EXPECT_EQ(aitken_factor(0.4, Vector{1, 2}, Vector{1, 2}), 0.4);
}

TEST(Aitken, solves_a_scalar_linear_map_in_three_passes_even_if_plain_iteration_blows_up) {
  for (const double slope : {-20., -3., -0.5, 0.5, 3.}) {
    Acceleration acceleration({});
    const auto result = solve(linear_map({slope}, {2.}), 1, acceleration);
    EXPECT_LE(result.iterations, 3) << slope;
    EXPECT_NEAR(result.image.displacement[0], 2 / (1 - slope), 1e-9) << slope;
  }
}

TEST(Aitken, solves_a_map_of_several_modes) {
  Acceleration acceleration({});
  const auto result = solve(linear_map({-9, -2, -0.3, 0.1}, {1, 2, 3, 4}), 4, acceleration);
  EXPECT_LE(result.iterations, 60);
  EXPECT_NEAR(result.image.displacement[0], 0.1, 1e-8);
  EXPECT_NEAR(result.image.displacement[2], 3 / 1.3, 1e-8);
}

TEST(ConstantRelaxation, converges_at_the_rate_of_theory) {
  AccelerationParameters parameters;
  parameters.type = AccelerationParameters::Type::constant;
  parameters.initial_relaxation = 0.25;
  Acceleration acceleration(parameters);
  // x' = x + w (b - (1 - a) x): the error shrinks by 1 - w (1 - a) = 0.5 a pass.
  const auto result = solve(linear_map({-1.}, {1.}), 1, acceleration, 1e-6);
  EXPECT_NEAR(result.iterations, 1 + std::log2(1e6), 3);
}

TEST(Acceleration, a_step_starts_with_the_last_factor_within_bounds) {
  AccelerationParameters parameters;
  parameters.initial_relaxation = 0.5;
  parameters.maximum_relaxation = 0.8;
  Acceleration acceleration(parameters);
  acceleration.start_step();
  EXPECT_EQ(acceleration.omega(), 0.5);
  acceleration.restore(-0.3);
  acceleration.start_step();
  EXPECT_EQ(acceleration.omega(), 0.3) << "the sign is an accident";
  acceleration.restore(7);
  acceleration.start_step();
  EXPECT_EQ(acceleration.omega(), 0.8);
  acceleration.restore(1e-9);
  acceleration.start_step();
  EXPECT_EQ(acceleration.omega(), 0.01);
}

TEST(FixedPoint, velocity_follows_the_combinations_of_the_displacement) {
  Acceleration acceleration({});
  const auto result = solve(linear_map({-4, 0.2}, {1, 1}), 2, acceleration);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(result.x.velocity[i], 10 * result.x.displacement[i], 1e-8);
}

TEST(FixedPoint, without_convergence_it_says_how_far_it_came) {
  AccelerationParameters parameters;
  parameters.type = AccelerationParameters::Type::constant;
  parameters.initial_relaxation = 1;
  Acceleration acceleration(parameters);
  try {
    solve(linear_map({-3.}, {1.}), 1, acceleration, 1e-10, 5);
    FAIL() << "it converged";
  } catch (const SolveFailure& failure) {
    EXPECT_STREQ(
        failure.what(),
        "the coupling did not converge in 5 iterations: the relative residual is 1.33e+00 (1.0e-10 is asked "
        "for).");
  }
}

TEST(FixedPoint, a_residual_that_is_not_finite_is_a_failure) {
  Acceleration acceleration({});
  EXPECT_THROW(solve(linear_map({NAN}, {1.}), 1, acceleration), SolveFailure);
}

TEST(Residual, is_relative_to_the_image_and_absolute_as_root_mean_square) {
  const Residual r = measure(Vector{3, 4, 0, 0}, Vector{0, 30, 40, 0}, 2);
  EXPECT_NEAR(r.relative, 0.1, 1e-15);
  EXPECT_NEAR(r.absolute, 5 / std::sqrt(2.), 1e-15) << "two vertices, one off by 5 m";
}

TEST(Residual, at_rest_is_converged) { EXPECT_TRUE(converged(measure(Vector{0, 0}, Vector{0, 0}, 2), {})); }

TEST(Residual, either_criterion_suffices) {
  ConvergenceParameters p;
  p.relative = 1e-3;
  p.absolute = 1e-6;
  EXPECT_TRUE(converged({1e-4, 1}, p));
  EXPECT_TRUE(converged({1, 1e-7}, p));
  EXPECT_FALSE(converged({1e-2, 1e-5}, p));
}

}  // namespace
}  // namespace couplet
