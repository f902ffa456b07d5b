// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/linear_solver.hpp"
#include "tests/support/test.hpp"

namespace couplet::linear_solver_test {
using namespace linalg;

/// The 5-point Laplacian on n x n cells, rows dealt out in blocks; `dirichlet`: unit diagonal share on the
/// left side.
struct Poisson {
  int n;
  GlobalIndex first, last;
  std::vector<GlobalIndex> row, column;
  std::vector<double> value;

  Poisson(int n_, bool dirichlet) : n(n_) {
    const GlobalIndex total = GlobalIndex(n) * n;
    const int rank = parallel::comm_rank(MPI_COMM_WORLD), size = parallel::comm_size(MPI_COMM_WORLD);
    first = total * rank / size;
    last = total * (rank + 1) / size;
    for (GlobalIndex r = first; r < last; ++r) {
      const GlobalIndex i = r % n, j = r / n;
      const auto link = [&](GlobalIndex neighbour, bool inside) {
        if (!inside) return;
        add(r, r, 1);
        add(r, neighbour, -1);
      };
      link(r - 1, i > 0);
      link(r + 1, i < n - 1);
      link(r - n, j > 0);
      link(r + n, j < n - 1);
      if (dirichlet && i == 0) add(r, r, 2);
    }
  }
  void add(GlobalIndex r, GlobalIndex c, double v) {
    row.push_back(r);
    column.push_back(c);
    value.push_back(v);
  }
  SparseMatrix matrix() const {
    SparseMatrix m(MPI_COMM_WORLD, last - first, row, column);
    m.fill(value);
    return m;
  }
};

double relative_residual(const SparseMatrix& m, const std::vector<double>& x, const std::vector<double>& b) {
  std::vector<double> y(x.size());
  m.multiply(x, y);
  double r = 0, n = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    r += (b[i] - y[i]) * (b[i] - y[i]);
    n += b[i] * b[i];
  }
  return std::sqrt(parallel::sum(MPI_COMM_WORLD, r) / parallel::sum(MPI_COMM_WORLD, n));
}

TEST(LinearSolver, every_method_reaches_its_tolerance) {
  const Poisson poisson(24, true);
  const SparseMatrix matrix = poisson.matrix();
  std::vector<double> b(poisson.last - poisson.first);
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::sin(double(poisson.first + i));
  for (const LinearMethod method :
       {LinearMethod::direct, LinearMethod::direct_symmetric, LinearMethod::direct_planar,
        LinearMethod::cg_direct, LinearMethod::cg_multigrid, LinearMethod::gmres_multigrid,
        LinearMethod::bicgstab_ilu}) {
    LinearSolver solver("u", matrix, {.method = method, .relative_tolerance = 1e-10});
    std::vector<double> x(b.size(), 0.0);
    solver.solve(b, x);
    EXPECT_LT(relative_residual(matrix, x, b), 2e-10) << int(method);
  }
}

TEST(LinearSolver, a_singular_neumann_problem_is_solved_up_to_a_constant_once_one_entry_is_pinned) {
  Poisson poisson(32, false);
  const SparseMatrix matrix = poisson.matrix();
  if (poisson.first == 0)
    poisson.add(0, 0, 2);  // twice the first diagonal entry, as the closed fluid does it
  const SparseMatrix pinned = poisson.matrix();
  std::vector<double> b(poisson.last - poisson.first), x(b.size(), 0.0);
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double s = (double((poisson.first + i) % 32) + 0.5) / 32;
    b[i] = std::cos(std::numbers::pi * s);  // sums to zero
  }
  LinearSolver solver("p", pinned, {.relative_tolerance = 1e-10});
  const auto statistics = solver.solve(b, x);
  EXPECT_LT(relative_residual(matrix, x, b), 2e-10);
  EXPECT_LT(statistics.iterations, 40);
}

TEST(LinearSolver, an_exact_guess_costs_no_iteration_and_the_preconditioner_is_kept) {
  const Poisson poisson(24, true);
  const SparseMatrix matrix = poisson.matrix();
  std::vector<double> b(poisson.last - poisson.first, 1.0), x(b.size(), 0.0);
  LinearSolver solver("p", matrix, {.relative_tolerance = 1e-8});
  EXPECT_GT(solver.solve(b, x).iterations, 0);
  EXPECT_EQ(solver.solve(b, x).iterations, 0);
  EXPECT_EQ(solver.preconditioners_built(), 1);
}

TEST(LinearSolver, a_preconditioner_that_no_longer_fits_is_made_anew) {
  Poisson poisson(24, true);
  SparseMatrix matrix = poisson.matrix();
  std::vector<double> b(poisson.last - poisson.first, 1.0), x(b.size(), 0.0);
  LinearSolver solver("p", matrix, {.relative_tolerance = 1e-8});
  solver.solve(b, x);
  for (std::size_t t = 0; t < poisson.value.size(); ++t)  // strong anisotropy the old hierarchy does not know
    if (std::abs(poisson.row[t] - poisson.column[t]) > 1) poisson.value[t] *= 1000;
  // Keep the rows' sums: rebuild the diagonal.
  std::vector<double> diagonal(poisson.last - poisson.first, 0.0);
  for (std::size_t t = 0; t < poisson.value.size(); ++t)
    if (poisson.row[t] != poisson.column[t]) diagonal[poisson.row[t] - poisson.first] -= poisson.value[t];
  for (std::size_t t = 0; t < poisson.value.size(); ++t)
    if (poisson.row[t] == poisson.column[t]) {
      poisson.value[t] = diagonal[poisson.row[t] - poisson.first] + (poisson.row[t] % 24 == 0 ? 2 : 0);
      diagonal[poisson.row[t] - poisson.first] = 0;
    }
  matrix.fill(poisson.value);
  solver.matrix_changed();
  std::vector<double> first(b.size(), 0.0), second(b.size(), 0.0);
  const int stale = solver.solve(b, first).iterations;  // fails with the old one, so it is made anew
  const int fresh = solver.solve(b, second).iterations;
  EXPECT_EQ(solver.preconditioners_built(), 2);
  EXPECT_LT(fresh, stale);
  EXPECT_LT(relative_residual(matrix, first, b), 2e-8);
}

TEST(LinearSolver, goes_on_where_bicgstab_is_slow_or_breaks_down) {
  // Hardly more than a skew-symmetric matrix: eigenvalues 0.2 +- b i.
  Poisson turning(20, false);
  for (std::size_t k = 0; k < turning.value.size(); ++k)
    turning.value[k] =
        turning.row[k] == turning.column[k] ? 0 : (turning.column[k] > turning.row[k] ? 1 : -1);
  for (GlobalIndex r = turning.first; r < turning.last; ++r) turning.add(r, r, 0.2);
  const SparseMatrix matrix = turning.matrix();
  std::vector<double> b(turning.last - turning.first), x(b.size(), 0.0);
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::sin(double(turning.first + i));
  LinearSolver solver(
      "u", matrix, {.method = LinearMethod::bicgstab_ilu, .relative_tolerance = 1e-9, .max_iterations = 800});
  const SolveStatistics s = solver.solve(b, x);
  EXPECT_LE(relative_residual(matrix, x, b), 2e-9);
  EXPECT_GT(s.iterations, 330) << "BiCGStab did it alone";
}

TEST(LinearSolver, a_failed_solve_says_what_and_why) {
  const Poisson poisson(32, true);
  const SparseMatrix matrix = poisson.matrix();
  std::vector<double> b(poisson.last - poisson.first, 1.0), x(b.size(), 0.0);
  LinearSolver solver("pressure", matrix, {.relative_tolerance = 1e-12, .max_iterations = 1});
  EXPECT_THAT(support::error_of<SolveFailure>([&] { solver.solve(b, x); }),
              testing::AllOf(testing::HasSubstr("pressure"), testing::HasSubstr("DIVERGED_ITS")));
}

TEST(LinearSolver, factors_of_a_singular_matrix_fail_by_name_on_any_number_of_ranks) {
  Poisson nothing(8, true);
  std::ranges::fill(nothing.value, 0.0);
  const SparseMatrix matrix = nothing.matrix();
  std::vector<double> b(nothing.last - nothing.first, 1.0), x(b.size(), 0.0);
  LinearSolver solver("displacement", matrix, {.method = LinearMethod::direct});
  EXPECT_THAT(support::error_of<SolveFailure>([&] { solver.solve(b, x); }),
              testing::HasSubstr("displacement"));
}

}  // namespace couplet::linear_solver_test
