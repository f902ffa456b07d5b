// SPDX-License-Identifier: Apache-2.0
#include "common/modes/pencil.hpp"
#include "tests/support/test.hpp"

namespace couplet::pencil_test {
using namespace modes;
using linalg::LinearMap;

constexpr int n = 40;  // rows of a rank

/// x_i times value(i), with i counted over all ranks.
LinearMap diagonal(const std::function<double(double)>& value) {
  const double first = n * parallel::comm_rank(MPI_COMM_WORLD);
  return [value, first](std::span<const double> x, std::span<double> y) {
    for (std::size_t i = 0; i < x.size(); ++i) y[i] = value(first + double(i)) * x[i];
  };
}

double stiffness(double i) {
  return std::floor(i / 2) * 3;
}  // pairs of equal eigenvalues: 0, 0, 1.5, 1.5, ...
double mass(double) { return 2; }

Pencil pencil(double shift) {
  return {.comm = MPI_COMM_WORLD,
          .n = n,
          .k = diagonal(stiffness),
          .m = diagonal(mass),
          .solve = diagonal([shift](double i) { return 1 / (stiffness(i) - shift * mass(i)); })};
}

std::vector<double> any_start() {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(std::sin(1.0 + i + n * parallel::comm_rank(MPI_COMM_WORLD)));
  return x;
}

TEST(Pencil, finds_all_of_equal_lowest_eigenvalues) {
  const EigenModes found = lowest_modes(pencil(-1), 5, -1);
  EXPECT_THAT(found.eigenvalue, ::testing::Pointwise(::testing::DoubleNear(1e-7), {0., 0., 1.5, 1.5, 3.}));
  EXPECT_LT(found.worst_residual, 1e-6);
}

TEST(Pencil, refuses_modes_that_a_count_does_not_confirm) {
  const auto below = [](double s) { return GlobalIndex(2 * std::ceil(s / 1.5)); };
  EXPECT_EQ(lowest_modes(pencil(-1), 4, -1, below).eigenvalue.size(), 4U);
  EXPECT_THROW(lowest_modes(pencil(-1), 4, -1, [&](double s) { return below(s) + 1; }), SolveFailure);
}

TEST(Pencil, finds_the_largest_ratios) {
  const double last = (n * parallel::comm_size(MPI_COMM_WORLD) - 1) / 2.;
  Pencil of = pencil(0);
  of.k = diagonal([](double i) { return i; });
  of.solve = diagonal([](double i) { return 1 / mass(i); });
  EXPECT_THAT(largest_modes(of, 2).eigenvalue,
              ::testing::Pointwise(::testing::DoubleNear(1e-7), {last, last - 0.5}));
}

TEST(Pencil, bounds_the_least_quotient_from_above_and_passes_failures_on) {
  Pencil of = pencil(-1);
  const LowestQuotient some = lowest_quotient(of, any_start(), 3, [](const auto&) { return false; });
  const LowestQuotient more = lowest_quotient(of, any_start(), 40, [](const std::vector<double>& values) {
    return values.back() > 0.999 * values[values.size() - 2];
  });
  EXPECT_GT(some.value, more.value);
  EXPECT_GE(more.value, -1e-12);
  EXPECT_LT(more.value, 0.5);
  of.solve = [](std::span<const double>, std::span<double>) { throw SolveFailure("no factors"); };
  EXPECT_THROW(lowest_quotient(of, any_start(), 3, [](const auto&) { return false; }), SolveFailure);
}

TEST(NegativeCurvature, is_met_where_there_is_one_and_nowhere_else) {
  const LinearMap same = diagonal([](double) { return 1; });
  const auto look = [&](double least) {
    return find_negative_curvature(MPI_COMM_WORLD, diagonal([least](double i) { return i + least; }), same,
                                   any_start(), 1e-6, 500);
  };
  EXPECT_FALSE(look(0.5).is_negative);
  const Curvature found = look(-0.5);
  EXPECT_TRUE(found.is_negative);
  double along = 0;
  const double first = n * parallel::comm_rank(MPI_COMM_WORLD);
  for (std::size_t i = 0; i < found.x.size(); ++i)
    along += (first + double(i) - 0.5) * found.x[i] * found.x[i];
  EXPECT_LT(parallel::sum(MPI_COMM_WORLD, along), 0);
}

}  // namespace couplet::pencil_test
