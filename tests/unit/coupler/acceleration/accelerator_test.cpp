// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/accelerator.hpp"

#include <functional>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/quasi_newton.hpp"
#include "tests/support/test.hpp"

namespace couplet::accelerator_test {
using namespace coupler;

using Vector = std::vector<double>;

/// H(x) = A x + b with A = diag(slopes); its fixed point is b / (1 - slope). Velocity: the same in other
/// units.
std::function<Iterate(const Iterate&)> linear_map(const Vector& slopes, const Vector& b) {
  return [=](const Iterate& x) {
    Iterate image = x;
    for (std::size_t i = 0; i < b.size(); ++i) {
      image.unknown[i] = slopes[i] * x.unknown[i] + b[i];
      image.dependent[i] = 10 * image.unknown[i];
    }
    return image;
  };
}

std::vector<Residual> residual_of(const Iterate& x, const Iterate& image) {
  double r = 0, h = 0;
  for (std::size_t i = 0; i < x.unknown.size(); ++i) {
    r += (image.unknown[i] - x.unknown[i]) * (image.unknown[i] - x.unknown[i]);
    h += image.unknown[i] * image.unknown[i];
  }
  const double relative = h > 0 ? std::sqrt(r / h) : r > 0 ? INFINITY : r;
  return {{relative, std::sqrt(r / double(x.unknown.size()))}};
}

using Type = AccelerationParameters::Type;

AccelerationParameters of_type(Type type, double initial = 0.5) {
  AccelerationParameters parameters;
  parameters.type = type;
  parameters.initial_relaxation = initial;
  return parameters;
}

std::unique_ptr<Accelerator> make(Type type, double initial = 0.5) {
  return make_accelerator(of_type(type, initial), MPI_COMM_SELF);
}

/// Iterates from zero as the coupler does.
FixedPointResult solve(const std::function<Iterate(const Iterate&)>& map, std::size_t n,
                       Accelerator& accelerator, double tolerance = 1e-10) {
  ConvergenceParameters limits;
  limits.relative = tolerance;
  accelerator.start_step();
  Iterate x{Vector(n, 0.), Vector(n, 0.)};
  for (int k = 1; k <= 200; ++k) {
    const Iterate image = map(x);
    const std::vector<Residual> residuals = residual_of(x, image);
    if (has_converged(residuals, limits)) {
      accelerator.accept(x, image);
      return {x, image, residuals[0], k};
    }
    x = accelerator.next(std::move(x), image);
  }
  throw SolveFailure("not converged");
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
    const auto result = solve(linear_map({slope}, {2.}), 1, *make(Type::aitken));
    EXPECT_LE(result.iterations, 3) << slope;
    EXPECT_NEAR(result.image.unknown[0], 2 / (1 - slope), 1e-9) << slope;
  }
}

TEST(Aitken, solves_a_map_of_several_modes) {
  const auto result = solve(linear_map({-9, -2, -0.3, 0.1}, {1, 2, 3, 4}), 4, *make(Type::aitken));
  EXPECT_LE(result.iterations, 60);
  EXPECT_NEAR(result.image.unknown[0], 0.1, 1e-8);
  EXPECT_NEAR(result.image.unknown[2], 3 / 1.3, 1e-8);
}

TEST(ConstantRelaxation, converges_at_the_rate_of_theory) {
  // x' = x + w (b - (1 - a) x): the error shrinks by 1 - w (1 - a) = 0.5 a pass.
  const auto result = solve(linear_map({-1.}, {1.}), 1, *make(Type::constant, 0.25), 1e-6);
  EXPECT_NEAR(result.iterations, 1 + std::log2(1e6), 3);
}

TEST(Aitken, a_step_starts_with_the_factor_of_the_second_pass_before) {
  // Two modes; the first factor that the second pass finds is close to the best for the strong one, the last
  // factor of the step belongs to the weak one.
  const auto accelerator = make(Type::aitken);
  solve(linear_map({-20, -0.1}, {1, 0.01}), 2, *accelerator);
  accelerator->start_step();
  EXPECT_NEAR(accelerator->relaxation(), 1. / 21, 1e-4);
}

TEST(Aitken, the_first_factor_of_a_step_is_bounded) {
  for (const auto& [slope, wanted] : {std::pair{0.5, 1.}, std::pair{-1e6, 1e-3}, std::pair{3., 0.5}}) {
    const auto accelerator = make(Type::aitken);
    solve(linear_map({slope}, {1}), 1, *accelerator);
    accelerator->start_step();
    EXPECT_NEAR(accelerator->relaxation(), wanted, 1e-12) << slope;
  }
}

TEST(Aitken, a_factor_is_never_far_above_the_maximum) {
  const auto accelerator = make(Type::aitken);
  accelerator->start_step();
  accelerator->next({{0}, {}}, {{1}, {}});
  accelerator->next({{0.5}, {}}, {{1.5 - 1e-9}, {}});
  EXPECT_EQ(accelerator->relaxation(), 10) << "unbounded it is 5e8";
}

TEST(FixedPoint, velocity_follows_the_combinations_of_the_displacement) {
  for (const Type type : {Type::constant, Type::aitken, Type::iqn_ils}) {
    const auto result = solve(linear_map({-4, 0.2}, {1, 1}), 2, *make(type, 0.2));
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(result.x.dependent[i], 10 * result.x.unknown[i], 1e-8);
  }
}

TEST(Residual, at_rest_is_converged) {
  EXPECT_TRUE(has_converged(residual_of({{0, 0}, {}}, {{0, 0}, {}}), {}));
}

TEST(Residual, either_criterion_suffices) {
  ConvergenceParameters p;
  p.relative = 1e-3;
  p.absolute = 1e-6;
  EXPECT_TRUE(has_converged({{1e-4, 1}}, p));
  EXPECT_TRUE(has_converged({{1, 1e-7}}, p));
  EXPECT_FALSE(has_converged({{1e-2, 1e-5}}, p));
}

}  // namespace couplet::accelerator_test
