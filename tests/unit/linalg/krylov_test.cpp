// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/krylov.hpp"

#include "common/linalg/acceleration.hpp"
#include "common/linalg/component_multigrid.hpp"
#include "common/linalg/residual_projection.hpp"
#include "tests/support/test.hpp"

namespace couplet::krylov_test {
using namespace linalg;
using namespace parallel;

/// Upwind convection and diffusion on a line of n cells a rank, uncoupled between ranks: not symmetric.
void convect(std::span<const double> x, std::span<double> y) {
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < n; ++i)
    y[i] = 3 * x[i] - (i > 0 ? 2 * x[i - 1] : 0) - (i + 1 < n ? 0.9 * x[i + 1] : 0);
}
void identity(std::span<const double> r, std::span<double> z) { std::copy(r.begin(), r.end(), z.begin()); }

double true_residual(std::span<const double> b, std::span<const double> x) {
  std::vector<double> y(x.size());
  convect(x, y);
  double square = 0, size = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    square += (b[i] - y[i]) * (b[i] - y[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(sum(MPI_COMM_WORLD, square) / sum(MPI_COMM_WORLD, size));
}

TEST(KrylovSolver, reaches_the_tolerance_in_the_true_residual) {
  const std::size_t n = 200;
  KrylovSolver solver("u", MPI_COMM_WORLD, n, convect, identity);
  std::vector<double> b(n), x(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) b[i] = std::sin(0.3 * double(i));
  for (const double tolerance : {1e-3, 1e-8, 1e-13}) {
    const SolveStatistics s = solver.solve(b, x, {tolerance, 500});
    EXPECT_LE(true_residual(b, x), tolerance);
    EXPECT_GT(s.iterations, 0);
  }
}

TEST(KrylovSolver, what_is_not_finite_never_counts_as_converged) {
  const std::size_t n = 20;
  const double nan = std::nan("");
  std::vector<double> b(n, 1.0), x(n, 0.0);
  KrylovSolver good("u", MPI_COMM_WORLD, n, convect, identity);
  b[3] = nan;
  EXPECT_THROW(good.solve(b, x, {1e-8, 50}), SolveFailure) << "right-hand side";
  b[3] = 1;
  x[5] = nan;
  EXPECT_THROW(good.solve(b, x, {1e-8, 50}), SolveFailure) << "guess";
  x.assign(n, 0.0);
  const auto poison = [&](std::span<const double> r, std::span<double> z) {
    std::fill_n(z.begin(), r.size(), nan);
  };
  KrylovSolver poisoned("u", MPI_COMM_WORLD, n, convect, poison);
  EXPECT_THROW(poisoned.solve(b, x, {1e-8, 50}), SolveFailure) << "preconditioner";
  x.assign(n, 0.0);
  EXPECT_NO_THROW(good.solve(b, x, {1e-8, 50}));
}

TEST(KrylovSolver, what_the_preconditioner_throws_reaches_the_caller_and_leaves_a_solver_that_works) {
  const std::size_t n = 200;
  for (const bool is_hard : {false, true}) {
    bool throws = true;
    const auto precondition = [&](std::span<const double> r, std::span<double> z) {
      if (throws) throw Error("no factors");
      identity(r, z);
    };
    KrylovSolver solver("u", MPI_COMM_WORLD, n, convect, precondition);
    const std::vector<double> b(n, 1.0);
    std::vector<double> x(n, 0.0);
    EXPECT_THAT(
        [&] {
          solver.solve(b, x, {1e-8, 500, false, is_hard});
        },
        ::testing::ThrowsMessage<Error>(::testing::HasSubstr("no factors")));
    throws = false;
    x.assign(n, 0.0);
    solver.solve(b, x, {1e-8, 500, false, is_hard});
    EXPECT_LE(true_residual(b, x), 1e-8);
  }
}

TEST(KrylovSolver, a_good_guess_costs_no_iteration) {
  const std::size_t n = 50;
  KrylovSolver solver("u", MPI_COMM_WORLD, n, convect, identity);
  std::vector<double> x(n), b(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = std::cos(double(i));
  convect(x, b);
  const std::vector<double> before = x;
  EXPECT_EQ(solver.solve(b, x, {1e-10, 10}).iterations, 0);
  EXPECT_EQ(x, before);
}

/// Right-hand side number k: a combination of three shapes whose shares move smoothly.
std::vector<double> moving_load(std::size_t n, int k) {
  std::vector<double> b(n);
  for (std::size_t i = 0; i < n; ++i)
    b[i] = std::sin(0.3 * double(i)) + 0.1 * k * std::cos(0.2 * double(i)) +
           0.03 * k * k * std::sin(0.05 * double(i));
  return b;
}

TEST(ResidualProjection, a_load_made_of_earlier_ones_costs_no_iteration) {
  const std::size_t n = 200;
  KrylovSolver solver("u", MPI_COMM_WORLD, n, convect, identity);
  ResidualProjection projection(MPI_COMM_WORLD, 3);
  for (int k = 0; k < 8; ++k) {
    std::vector<double> x(n, 0.0);
    const std::vector<double> b = moving_load(n, k);
    // The corrections that are kept are good to 1e-12; what they leave is larger, but far below 1e-8.
    const double tolerance = k < 3 ? 1e-12 : 1e-8;
    const SolveStatistics s = solver.solve(b, x, {tolerance, 500}, &projection);
    EXPECT_LE(true_residual(b, x), tolerance);
    if (k < 3) {
      EXPECT_GT(s.iterations, 3) << k;
      projection.accept();
    } else {
      EXPECT_EQ(s.iterations, 0) << k;
    }
  }
}

TEST(ResidualProjection, a_solve_that_is_not_accepted_leaves_no_trace) {
  const std::size_t n = 200;
  KrylovSolver solver("u", MPI_COMM_WORLD, n, convect, identity);
  ResidualProjection projection(MPI_COMM_WORLD, 4);
  std::vector<double> x(n, 0.0), first(n, 0.0), again(n, 0.0);
  solver.solve(moving_load(n, 0), x, {1e-9, 500}, &projection);
  projection.accept();
  solver.solve(moving_load(n, 1), first, {1e-9, 500}, &projection);
  solver.solve(moving_load(n, 5), x, {1e-9, 500}, &projection);
  solver.solve(moving_load(n, 1), again, {1e-9, 500}, &projection);
  EXPECT_EQ(first, again);
}

TEST(ResidualProjection, continues_from_its_values_and_forgets_those_of_another_operator) {
  const std::size_t n = 200;
  KrylovSolver solver("u", MPI_COMM_WORLD, n, convect, identity);
  ResidualProjection one(MPI_COMM_WORLD, 3), other(MPI_COMM_WORLD, 3), foreign(MPI_COMM_WORLD, 3);
  for (int k = 0; k < 5; ++k) {
    std::vector<double> x(n, 0.0);
    solver.solve(moving_load(n, k), x, {1e-9, 500}, &one);
    one.accept();
  }
  const auto saved = [&] {
    std::vector<std::vector<double>> all;
    for (const std::span<const double> v : one.vectors()) all.emplace_back(v.begin(), v.end());
    return all;
  };
  other.set_values(one.products(), saved(), convect);
  std::vector<double> x(n, 0.0), y(n, 0.0), z(n, 0.0), fresh(n, 0.0);
  const std::vector<double> b = moving_load(n, 5);
  solver.solve(b, x, {1e-9, 500}, &one);
  solver.solve(b, y, {1e-9, 500}, &other);
  EXPECT_EQ(x, y);
  foreign.set_values(one.products(), saved(), identity);
  solver.solve(b, z, {1e-9, 500}, &foreign);
  solver.solve(b, fresh, {1e-9, 500});
  EXPECT_EQ(z, fresh);
}

/// Eigenvalues in 1 to 1.5, but for 2 x 2 blocks that hardly do anything but turn: 0.02 +- b i.
void turning(std::span<const double> x, std::span<double> y) {
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < n; ++i) y[i] = (1 + 0.5 * double(i) / double(n)) * x[i];
  for (std::size_t i = 0; i + 1 < n; i += 20) {
    const double b = 0.2 + 0.5 * double(i) / double(n);
    y[i] = 0.02 * x[i] + b * x[i + 1];
    y[i + 1] = 0.02 * x[i + 1] - b * x[i];
  }
}

TEST(KrylovSolver, a_few_eigenvalues_far_from_the_others_do_not_stop_it) {
  const std::size_t n = 400;
  KrylovSolver solver("u", MPI_COMM_WORLD, n, turning, identity);
  std::vector<double> exact(n), b(n), x(n, 0.0), r(n);
  for (std::size_t i = 0; i < n; ++i) exact[i] = std::sin(0.3 * double(i));
  turning(exact, b);
  const SolveStatistics s = solver.solve(b, x, {1e-9, 150});
  EXPECT_GT(s.iterations, 50) << "too easy to reach the second method";
  turning(x, r);
  double square = 0, size = 0;
  for (std::size_t i = 0; i < n; ++i) {
    square += (b[i] - r[i]) * (b[i] - r[i]);
    size += b[i] * b[i];
  }
  EXPECT_LE(sum(MPI_COMM_WORLD, square), 1e-18 * sum(MPI_COMM_WORLD, size));
  std::vector<double> cut_short(n, 0.0);
  EXPECT_THAT(
      [&] {
        solver.solve(b, cut_short, {1e-9, 55});
      },
      ::testing::ThrowsMessage<SolveFailure>(::testing::HasSubstr("GMRES after BiCGStab reached")));
  // Again from there, and from the start: the same.
  std::vector<double> again(n, 0.0);
  EXPECT_EQ(solver.solve(b, x, {1e-8, 150}).iterations, 0);
  solver.solve(b, again, {1e-9, 150});
  x.assign(n, 0.0);
  KrylovSolver fresh("u", MPI_COMM_WORLD, n, turning, identity);
  fresh.solve(b, x, {1e-9, 150});
  EXPECT_EQ(x, again);
}

// M^-1 = I + 1e9 v v^T: of what BiCGStab makes of that nothing stays, and GMRES loses no digits to it.
TEST(KrylovSolver, a_preconditioner_that_is_nearly_singular_does_not_stop_it) {
  const std::size_t n = 200;
  const auto amplify = [](std::span<const double> r, std::span<double> z) {
    const double length = std::sqrt(double(r.size()));
    double along = 0;
    for (std::size_t i = 0; i < r.size(); ++i) along += std::cos(0.7 * double(i * i)) / length * r[i];
    for (std::size_t i = 0; i < r.size(); ++i)
      z[i] = r[i] + 1e9 * along * std::cos(0.7 * double(i * i)) / length;
  };
  KrylovSolver solver("u", MPI_COMM_WORLD, n, convect, amplify);
  std::vector<double> b(n), x(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) b[i] = std::sin(0.3 * double(i));
  const SolveStatistics s = solver.solve(b, x, {1e-4, 500});
  EXPECT_LE(true_residual(b, x), 1e-4);
  EXPECT_LT(s.iterations, 150);
}

TEST(KrylovSolver, says_what_was_reached_when_it_fails) {
  const std::size_t n = 200;
  KrylovSolver solver("displacement", MPI_COMM_WORLD, n, convect, identity);
  std::vector<double> b(n, 1.0), x(n, 0.0);
  const std::string said = support::error_of<SolveFailure>([&] { solver.solve(b, x, {1e-12, 3}); });
  EXPECT_THAT(said, ::testing::HasSubstr("displacement"));
  EXPECT_THAT(said, ::testing::HasSubstr("tolerance 1.000e-12"));
  EXPECT_THAT(said, ::testing::HasSubstr("3 of at most 3 iterations"));
}

using Lanes = ComponentMultigrid::Lanes;

/// Seven-point Laplacians on n x n x n cells, Dirichlet on one side, three components with different
/// anisotropy; this rank's layers of them, those of its neighbours as ghosts.
struct Laplacians {
  ComponentMultigrid::Rows rows;
  IndexMap map;
};

Laplacians laplacians(int n, MPI_Comm comm) {
  const int rank = comm_rank(comm), size = comm_size(comm);
  const auto first_of = [&](int r) { return n * r / size; };
  const int low = first_of(rank), high = first_of(rank + 1), n_owned = n * n * (high - low);
  Laplacians result;
  ComponentMultigrid::Rows& rows = result.rows;
  const std::array<Lanes, 3> k = {Lanes{3, 1, 1, 0}, Lanes{1, 3, 1, 0}, Lanes{1, 1, 3, 0}};  // along x, y, z
  std::vector<int> owner;
  std::vector<Index> there;
  for (const int layer : {low - 1, high}) {
    if (layer < 0 || layer == n) continue;
    const int other = layer < low ? rank - 1 : rank + 1;
    for (int i = 0; i < n * n; ++i) {
      owner.push_back(other);
      there.push_back(static_cast<Index>(i + n * n * (layer - first_of(other))));
    }
  }
  result.map = IndexMap(comm, n_owned, owner, there);
  const auto at = [&](int i, int j, int l) {
    if (l >= low && l < high) return static_cast<Index>(i + n * (j + n * (l - low)));
    return static_cast<Index>(n_owned + i + n * j + (l == high && low > 0 ? n * n : 0));
  };
  for (int l = low; l < high; ++l)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        Lanes diagonal{0, 0, 0, 1};
        const auto add = [&](int a, int b, int c, const Lanes& value) {
          if (a < 0 || b < 0 || c < 0 || a == n || b == n || c == n) return;
          rows.index.push_back(at(a, b, c));
          rows.value.push_back(-value);
          diagonal += value;
        };
        for (const int s : {-1, 1}) {
          add(i + s, j, l, k[0]);
          add(i, j + s, l, k[1]);
          add(i, j, l + s, k[2]);
        }
        if (i == 0) diagonal += 2 * k[0];
        rows.diagonal.push_back(diagonal);
        rows.offset.push_back(static_cast<Index>(rows.index.size()));
      }
  return result;
}

/// The same without the couplings to other ranks, which stay on the diagonal.
ComponentMultigrid::Rows alone(const ComponentMultigrid::Rows& rows) {
  ComponentMultigrid::Rows result;
  result.diagonal = rows.diagonal;
  for (Index i = 0; i < rows.size(); ++i) {
    for (Index e = rows.offset[i]; e < rows.offset[i + 1]; ++e) {
      if (rows.index[e] >= rows.size()) continue;
      result.index.push_back(rows.index[e]);
      result.value.push_back(rows.value[e]);
    }
    result.offset.push_back(static_cast<Index>(result.index.size()));
  }
  return result;
}

int iterations_with_multigrid(int n, bool with_the_others = true) {
  const Laplacians all = laplacians(n, MPI_COMM_WORLD);
  const ComponentMultigrid::Rows& rows = all.rows;
  ComponentMultigrid multigrid = with_the_others ? ComponentMultigrid(rows, {1, &all.map, MPI_COMM_WORLD})
                                                 : ComponentMultigrid(alone(rows));
  std::vector<double> local(std::size_t(all.map.n_local()) * 3);
  const auto apply = [&](std::span<const double> x, std::span<double> y) {
    std::ranges::copy(x, local.begin());
    all.map.update_ghosts(local, 3);
    for (Index i = 0; i < rows.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        double sum = rows.diagonal[i][c] * x[std::size_t(i) * 3 + c];
        for (Index e = rows.offset[i]; e < rows.offset[i + 1]; ++e)
          sum += rows.value[e][c] * local[std::size_t(rows.index[e]) * 3 + c];
        y[std::size_t(i) * 3 + c] = sum;
      }
  };
  const auto precondition = [&](std::span<const double> r, std::span<double> z) { multigrid.apply(r, z, 3); };
  const std::size_t size = std::size_t(rows.size()) * 3;
  KrylovSolver solver("u", MPI_COMM_WORLD, size, apply, precondition);
  std::vector<double> b(size), x(size, 0.0);
  const auto first = double(all.map.first() * 3);
  for (std::size_t i = 0; i < size; ++i) b[i] = std::sin(0.01 * (first + double(i))) + 0.2;
  return solver.solve(b, x, {1e-10, 200}).iterations;
}

TEST(ComponentMultigrid, iterations_hardly_grow_with_the_mesh_nor_with_the_ranks) {
  const int coarse = iterations_with_multigrid(8), fine = iterations_with_multigrid(32);
  const bool few = comm_size(MPI_COMM_WORLD) < 3;
  EXPECT_LE(coarse, few ? 9 : 10);
  EXPECT_LE(fine, few ? 14 : 18);
}

// The failing neighbour: cycles of each rank alone.
TEST(ComponentMultigrid, iterations_grow_with_the_ranks_where_none_knows_of_another) {
  if (comm_size(MPI_COMM_WORLD) > 1) {
    EXPECT_GT(iterations_with_multigrid(32, false), 40);
  }
}

/// A line of which each rank has every third row or so: no rank has neighbors of its own, and nothing is coarsened until
/// the rows of all are gathered. Smoothing alone would need some thousand iterations.
TEST(ComponentMultigrid, rows_that_are_dealt_to_the_ranks_in_turn_are_gathered) {
  const int size = comm_size(MPI_COMM_WORLD), rank = comm_rank(MPI_COMM_WORLD), n = 3000;
  AggregationMultigrid<float>::Rows rows;
  std::vector<int> owner;
  std::vector<Index> there;
  const Index n_owned = (n - rank + size - 1) / size;
  for (int g = rank; g < n; g += size) {
    for (const int other : {g - 1, g + 1}) {
      if (other < 0 || other == n) continue;
      rows.value.push_back(-1);
      if (other % size == rank) {
        rows.index.push_back(other / size);
        continue;
      }
      rows.index.push_back(n_owned + Index(owner.size()));
      owner.push_back(other % size);
      there.push_back(other / size);
    }
    rows.diagonal.push_back(2);
    rows.offset.push_back(Index(rows.index.size()));
  }
  const IndexMap map(MPI_COMM_WORLD, n_owned, owner, there);
  AggregationMultigrid<float> multigrid(rows, {1, &map, MPI_COMM_WORLD});
  std::vector<double> local(map.n_local()), b(n_owned, 1.0), x(n_owned, 0.0);
  const auto apply = [&](std::span<const double> u, std::span<double> y) {
    std::ranges::copy(u, local.begin());
    map.update_ghosts(local);
    for (Index i = 0; i < n_owned; ++i) {
      y[i] = 2 * u[i];
      for (Index e = rows.offset[i]; e < rows.offset[i + 1]; ++e) y[i] -= local[rows.index[e]];
    }
  };
  const auto precondition = [&](std::span<const double> r, std::span<double> z) { multigrid.apply(r, z, 1); };
  KrylovSolver solver("u", MPI_COMM_WORLD, n_owned, apply, precondition);
  EXPECT_LE(solver.solve(b, x, {1e-8, 200}).iterations, 60);
  for (Index i = 0; i < n_owned; ++i) {
    const double g = double(rank + i * size + 1);
    EXPECT_NEAR(x[i], g * (n + 1 - g) / 2, 1e-5 * n * n);
  }
}

TEST(ComponentMultigrid, components_do_not_see_each_other) {
  ComponentMultigrid multigrid(laplacians(12, MPI_COMM_SELF).rows);
  const std::size_t n = 12 * 12 * 12;
  std::vector<double> b(3 * n, 0.0), x(3 * n);
  for (std::size_t i = 0; i < n; ++i) b[3 * i + 1] = 1;
  multigrid.apply(b, x, 3);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(x[3 * i], 0);
    EXPECT_GT(x[3 * i + 1], 0);
    EXPECT_EQ(x[3 * i + 2], 0);
  }
}

// A contraction by `rate` to u = 1.
std::vector<double> step_to_one(std::span<const double> u, double rate) {
  std::vector<double> step;
  for (const double x : u) step.push_back((1 - rate) * (1 - x));
  return step;
}

TEST(Acceleration, aitken_lands_on_the_fixed_point_of_a_contraction) {
  VectorAccelerator accelerator(MPI_COMM_WORLD, 3, {Acceleration::Type::aitken, 5, 0});
  std::vector<double> u{5, -3, 0.5};
  for (int k = 0; k < 4; ++k) {
    accelerator.advance(u, step_to_one(u, 0.8));
    EXPECT_GT(std::abs(u[0] - 1), 0.1);
  }
  accelerator.advance(u, step_to_one(u, 0.8));
  for (const double x : u) EXPECT_NEAR(x, 1, 1e-12);
}

TEST(Acceleration, anderson_solves_as_many_unknowns_as_it_remembers_and_forgets_the_oldest) {
  // Four different rates: plain iteration would need hundreds of steps. With a history of three, Anderson's
  // combination drops its oldest difference from the fifth step on and needs twelve.
  const std::array<double, 4> rate{0.99, 0.9, -0.5, 0.3};
  for (const auto& [history, steps] : {std::pair(4, 6), std::pair(3, 13)}) {
    VectorAccelerator accelerator(MPI_COMM_SELF, 4, {Acceleration::Type::anderson, 0, history});
    std::vector<double> u(4, 0.0), step(4);
    for (int k = 0; k < steps; ++k) {
      for (std::size_t i = 0; i < 4; ++i) step[i] = (1 - rate[i]) * (double(i) + 1 - u[i]);
      accelerator.advance(u, step);
    }
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(u[i], double(i) + 1, 1e-8) << "history " << history;
  }
}

}  // namespace couplet::krylov_test
