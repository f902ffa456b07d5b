// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/single_factors.hpp"

namespace couplet::single_factors_test {
using namespace linalg;
namespace {

/// -div grad on n x n cells that are `aspect` times as long as thick, held on two sides.
struct Grid {
  int n;
  std::vector<int> offset{0}, index;
  std::vector<double> value;

  Grid(int cells, double aspect) : n(cells) {
    const double across = aspect * aspect;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int c = j * n + i;
        double diagonal = (i == 0 || i == n - 1 ? 2 : 0) + (i > 0) + (i < n - 1);
        diagonal += across * ((j > 0) + (j < n - 1));
        if (j > 0) add(c - n, -across);
        if (i > 0) add(c - 1, -1);
        add(c, diagonal);
        if (i < n - 1) add(c + 1, -1);
        if (j < n - 1) add(c + n, -across);
        offset.push_back(static_cast<int>(index.size()));
      }
  }
  void add(int column, double v) {
    index.push_back(column);
    value.push_back(v);
  }
  std::vector<double> multiply(const std::vector<double>& x) const {
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t r = 0; r < y.size(); ++r)
      for (int k = offset[r]; k < offset[r + 1]; ++k) y[r] += value[k] * x[index[k]];
    return y;
  }
  SparseMatrix matrix() const {
    std::vector<GlobalIndex> row, column(index.begin(), index.end());
    for (int r = 0; r < n * n; ++r) row.insert(row.end(), offset[r + 1] - offset[r], r);
    SparseMatrix m(MPI_COMM_SELF, n * n, row, column);
    m.fill(value);
    return m;
  }
};

std::vector<double> waves(std::size_t n) {
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = 1 + std::sin(0.37 * double(i)) + std::cos(0.0011 * double(i));
  return x;
}

double relative_error(const std::vector<double>& x, const std::vector<double>& exact) {
  double error = 0, size = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    error += (x[i] - exact[i]) * (x[i] - exact[i]);
    size += exact[i] * exact[i];
  }
  return std::sqrt(error / size);
}

TEST(SingleFactors, solve_to_single_precision_whatever_the_size_of_the_right_side) {
  for (const int n : {1, 2, 7, 60}) {
    Grid grid(n, 1);
    SingleFactors factors;
    for (const double scale : {1.0, 3.0}) {  // a second time with other values
      for (double& v : grid.value) v *= scale;
      factors.factorise(grid.offset, grid.index, grid.value);
      for (const double size : {1.0, 1e-60, 1e60}) {
        std::vector<double> exact = waves(std::size_t(n) * n), x(exact.size());
        for (double& v : exact) v *= size;
        factors.apply(grid.multiply(exact), x);
        EXPECT_LT(relative_error(x, exact), 2e-5) << n;
      }
    }
  }
}

TEST(SingleFactors, a_matrix_that_is_not_positive_definite_is_refused) {
  Grid grid(8, 1);
  for (double& v : grid.value) v = -v;
  SingleFactors factors;
  EXPECT_THROW(factors.factorise(grid.offset, grid.index, grid.value), SolveFailure);
}

TEST(SingleFactors, serve_a_solver_in_few_iterations_or_are_given_up_where_cells_are_too_thin) {
  for (const double aspect : {1.0, 10.0, 1e4}) {
    const Grid grid(60, aspect);
    const SparseMatrix matrix = grid.matrix();
    const std::vector<double> b = waves(3600);
    LinearSolver solver("p", matrix, {.method = LinearMethod::cg_single, .relative_tolerance = 1e-10});
    std::vector<double> x(b.size(), 0.0), again(x);
    const int first = solver.solve(b, x).iterations, second = solver.solve(b, again).iterations;
    const bool thin = aspect > 1e3;
    EXPECT_EQ(solver.preconditioners_built(), thin ? 2 : 1) << first;
    EXPECT_LE(second, thin ? 2 : 4) << aspect;
    std::vector<double> residual = grid.multiply(again);
    // On the thin cells A x is itself rounded by a part in 1e5.
    EXPECT_LT(relative_error(residual, b), thin ? 1e-4 : 2e-10);
  }
}

}  // namespace
}  // namespace couplet::single_factors_test
