// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/quasi_newton.hpp"

#include <Eigen/Dense>

#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/accelerator.hpp"
#include "tests/support/test.hpp"

namespace couplet::quasi_newton_test {
using namespace coupler;

using Vector = std::vector<double>;
using Type = AccelerationParameters::Type;

AccelerationParameters of_quasi_newton(int reused = 8, Type type = Type::iqn_ils) {
  AccelerationParameters parameters;
  parameters.type = type;
  parameters.reused_steps = reused;
  return parameters;
}

/// H(x)_i = -ratio / (i + 1) x_i + b_i: a heavy fluid, 40 modes. The dependent is twice the unknown.
Iterate heavy(const Iterate& x, double ratio, double shift) {
  Iterate image = x;
  for (std::size_t i = 0; i < x.unknown.size(); ++i)
    image.unknown[i] = -ratio / double(i + 1) * x.unknown[i] + (1 + shift) / double(i + 1);
  image.dependent = image.unknown;
  for (double& v : image.dependent) v *= 2;
  return image;
}

/// Passes of one step from zero to 1e-6.
int step(Accelerator& accelerator, double ratio, double shift = 0, int most = 200,
         Iterate* result = nullptr) {
  accelerator.start_step();
  Iterate x{Vector(40, 0.), Vector(40, 0.)};
  for (int k = 1; k <= most; ++k) {
    const Iterate image = heavy(x, ratio, shift);
    double r = 0, h = 0;
    for (std::size_t i = 0; i < 40; ++i)
      r += std::pow(image.unknown[i] - x.unknown[i], 2), h += std::pow(image.unknown[i], 2);
    if (r <= 1e-12 * h) {
      accelerator.accept(x, image);
      if (result) *result = x;
      return k;
    }
    x = accelerator.next(x, image);
  }
  return most + 1;
}

Eigen::MatrixXd random_matrix(int rows, int columns, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}
Vector column(const Eigen::MatrixXd& a, int j) { return {a.col(j).data(), a.col(j).data() + a.rows()}; }

TEST(GrowingQr, minimises_like_a_dense_least_squares_solver_while_columns_come_and_go) {
  const Eigen::MatrixXd a = random_matrix(30, 12, 3);
  Eigen::MatrixXd kept(30, 0);
  GrowingQr qr(MPI_COMM_SELF);
  const auto join = [&](int j) {
    Eigen::MatrixXd grown(30, kept.cols() + 1);
    grown << a.col(j), kept;
    kept = grown;
    qr.push_front(column(a, j));
    EXPECT_TRUE(qr.drop(1e-10).empty());
  };
  const auto leave = [&](int j) {
    Eigen::MatrixXd shrunk(30, kept.cols() - 1);
    shrunk << kept.leftCols(j), kept.rightCols(kept.cols() - 1 - j);
    kept = shrunk;
    qr.erase(j);
  };
  const auto check = [&] {
    const Eigen::VectorXd r = random_matrix(30, 1, 7);
    const Eigen::VectorXd wanted = -kept.colPivHouseholderQr().solve(r);
    EXPECT_LT((qr.minimise({r.data(), 30}) - wanted).norm(), 1e-12 * wanted.norm()) << kept.cols();
  };
  for (int j = 0; j < 6; ++j) join(j), check();
  for (const int j : {5, 0, 2}) leave(j), check();
  for (int j = 6; j < 12; ++j) join(j), check();
  // Three thousand times the last or the one before it leaves and another joins; no two are alike, ever.
  for (int n = 0; n < 3000; ++n) {
    leave(int(kept.cols()) - 1 - n % 2);
    Eigen::MatrixXd fresh = random_matrix(30, 1, 100 + unsigned(n)), grown(30, kept.cols() + 1);
    grown << fresh, kept;
    kept = grown;
    qr.push_front(column(fresh, 0));
    EXPECT_TRUE(qr.drop(1e-10).empty());
  }
  check();
}

TEST(GrowingQr, drops_the_older_of_two_columns_that_say_the_same) {
  const Eigen::MatrixXd a = random_matrix(20, 4, 1);
  for (const double noise : {0., 1e-5}) {
    GrowingQr qr(MPI_COMM_SELF);
    for (int j = 0; j < 4; ++j) qr.push_front(column(a, j));
    const Vector again = column(a.col(1) * 3 + noise * random_matrix(20, 1, 9), 0);
    qr.push_front(again);
    EXPECT_EQ(qr.drop(1e-2), std::vector<int>{3}) << "order is now again, 3, 2, 1, 0";
    const Eigen::VectorXd c = qr.minimise(again);
    EXPECT_NEAR(c[0], -1, 1e-12);
    EXPECT_NEAR(c.tail(3).norm(), 0, 1e-12);
  }
}

TEST(GrowingQr, survives_a_column_of_zeros) {
  GrowingQr qr(MPI_COMM_SELF);
  qr.push_front({0, 0, 0});
  EXPECT_EQ(qr.drop(0), std::vector<int>{0});
  qr.push_front({0, 2, 0});
  qr.push_front({0, 0, 0});
  EXPECT_EQ(qr.drop(1e-2), std::vector<int>{0});
  EXPECT_NEAR(qr.minimise(Vector{1, 4, 1})[0], -2, 1e-14);
}

TEST(QuasiNewton, needs_a_pass_more_than_a_linear_map_has_modes) {
  const auto accelerator = make_accelerator(of_quasi_newton(), MPI_COMM_SELF);
  accelerator->start_step();
  Iterate x{{0, 0, 0}, {}};
  const auto map = [](const Iterate& x) {
    return Iterate{{-30 * x.unknown[0] + x.unknown[1] + 1, 4 * x.unknown[1] + 2, 0.5 * x.unknown[2]}, {}};
  };
  for (int k = 0; k < 4; ++k) x = accelerator->next(x, map(x));
  const Iterate image = map(x);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(x.unknown[i], image.unknown[i], 1e-11);
}

TEST(QuasiNewton, dependent_data_take_the_same_combinations) {
  const auto accelerator = make_accelerator(of_quasi_newton(), MPI_COMM_SELF);
  Iterate x;
  step(*accelerator, 20, 0, 200, &x);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(x.dependent[i], 2 * x.unknown[i], 1e-13);
}

TEST(QuasiNewton, earlier_steps_save_passes) {
  const auto with = make_accelerator(of_quasi_newton(), MPI_COMM_SELF);
  const auto without = make_accelerator(of_quasi_newton(0), MPI_COMM_SELF);
  const int first = step(*with, 20);
  EXPECT_EQ(step(*without, 20), first);
  int reused = 0, fresh = 0;
  for (int n = 1; n <= 5; ++n) reused += step(*with, 20, 0.1 * n), fresh += step(*without, 20, 0.1 * n);
  EXPECT_LE(2 * reused, fresh);
  EXPECT_EQ(with->resets(), 0);
}

TEST(QuasiNewton, keeps_no_more_steps_than_it_may) {
  AccelerationParameters parameters = of_quasi_newton(2);
  parameters.filter = 0;
  const auto two_steps = make_accelerator(parameters, MPI_COMM_SELF);
  parameters.reused_steps = 8;
  const auto all = make_accelerator(parameters, MPI_COMM_SELF);
  parameters.reused_steps = 0;
  const auto nothing = make_accelerator(parameters, MPI_COMM_SELF);
  for (int n = 0; n < 4; ++n) {
    for (const auto& a : {two_steps.get(), all.get(), nothing.get()}) step(*a, 20, 0.1 * n);
  }
  EXPECT_GT(all->columns(), 5);
  EXPECT_LT(two_steps->columns(), all->columns());
  EXPECT_GT(two_steps->columns(), 0);
  nothing->start_step();
  EXPECT_EQ(nothing->columns(), 0);
}

TEST(QuasiNewton, reuses_the_pairs_of_as_many_steps_as_it_may_and_of_no_more) {
  for (const int reused : {0, 1, 2, 4}) {
    AccelerationParameters parameters = of_quasi_newton(reused);
    parameters.filter = 0;
    const auto accelerator = make_accelerator(parameters, MPI_COMM_SELF);
    for (int n = 0; n < 7; ++n) {
      accelerator->start_step();
      EXPECT_EQ(accelerator->columns(), 2 * std::min(n, reused)) << "after " << n << " steps";
      const auto map =
          [&](const Iterate& x) {  // another one in each step, so that no pair says what others said
            return heavy(x, 0.5 + 0.03 * n * n, 0.7 * n);
          };
      Iterate x{Vector(40, 0.), Vector(40, 0.)};
      for (int k = 0; k < 2; ++k) x = accelerator->next(x, map(x));
      accelerator->accept(x, map(x));  // two pairs a step
      EXPECT_EQ(accelerator->resets(), 0);
    }
  }
}

/// What has been learnt of a linear map answers at once in the next step.
TEST(QuasiNewton, a_map_that_is_known_from_the_step_before_is_solved_by_one_update) {
  const auto map = [](const Iterate& x, double shift) {
    return Iterate{
        {-30 * x.unknown[0] + x.unknown[1] + 1, 4 * x.unknown[1] + 2 + shift, 0.5 * x.unknown[2] - shift},
        {}};
  };
  AccelerationParameters parameters = of_quasi_newton(1);
  parameters.filter = 1e-6;
  const auto accelerator = make_accelerator(parameters, MPI_COMM_SELF);
  Iterate x{{0, 0, 0}, {}};
  accelerator->start_step();
  for (int k = 0; k < 4; ++k) x = accelerator->next(x, map(x, 1));
  accelerator->accept(x, map(x, 1));
  accelerator->start_step();
  x = accelerator->next(x, map(x, 3));
  const Iterate image = map(x, 3);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(x.unknown[i], image.unknown[i], 1e-9);
}

/// After steps with one map comes another: what was learnt is wrong by far.
TEST(QuasiNewton, pairs_that_mislead_are_given_up) {
  const auto accelerator = make_accelerator(of_quasi_newton(), MPI_COMM_SELF);
  for (int n = 0; n < 3; ++n) step(*accelerator, 0.5, 0.1 * n);
  EXPECT_EQ(accelerator->resets(), 0);
  const int fresh = step(*make_accelerator(of_quasi_newton(), MPI_COMM_SELF), 200);
  EXPECT_LE(step(*accelerator, 200), fresh + 3);
  EXPECT_GE(accelerator->resets(), 1) << "one update had made it ten times worse";
}

TEST(QuasiNewton, starts_from_rest) {
  // Steps in which nothing moves leave no column, and the first motion after them is solved like any other.
  for (const Type type : {Type::aitken, Type::iqn_ils}) {
    const auto accelerator = make_accelerator(of_quasi_newton(8, type), MPI_COMM_SELF);
    for (int n = 0; n < 3; ++n) {
      accelerator->start_step();
      const Iterate still{Vector(40, 0.), Vector(40, 0.)};
      const Iterate next = accelerator->next(still, still);
      EXPECT_EQ(next.unknown, still.unknown);
      accelerator->next(next, still);
      accelerator->accept(still, still);
      EXPECT_EQ(accelerator->columns(), 0);
    }
    EXPECT_EQ(step(*accelerator, 5), step(*make_accelerator(of_quasi_newton(8, type), MPI_COMM_SELF), 5));
  }
}

TEST(QuasiNewton, takes_no_difference_across_a_change_of_the_map) {
  const auto accelerator = make_accelerator(of_quasi_newton(), MPI_COMM_SELF);
  accelerator->start_step();
  Iterate x{Vector(40, 0.), {}};
  for (int k = 0; k < 2; ++k) x = accelerator->next(x, heavy(x, 5, 0));
  EXPECT_EQ(accelerator->columns(), 1);
  accelerator->map_changed();
  x = accelerator->next(x, heavy(x, 5, 3));
  EXPECT_EQ(accelerator->columns(), 1);
  x = accelerator->next(x, heavy(x, 5, 3));
  EXPECT_EQ(accelerator->columns(), 2);
}

TEST(QuasiNewton, a_step_that_was_given_up_leaves_nothing) {
  const auto accelerator = make_accelerator(of_quasi_newton(), MPI_COMM_SELF);
  step(*accelerator, 20, 0, 4);
  accelerator->start_step();
  EXPECT_EQ(accelerator->columns(), 0);
}

TEST(Accelerators, continue_from_a_checkpoint_bit_for_bit) {
  const auto file =
      std::filesystem::temp_directory_path() / ("couplet-acc-" + std::to_string(::getpid()) + ".h5");
  for (const Type type : {Type::constant, Type::aitken, Type::iqn_ils}) {
    AccelerationParameters parameters = of_quasi_newton(3, type);
    if (type == Type::constant) parameters.initial_relaxation = 0.05;
    const auto whole = make_accelerator(parameters, MPI_COMM_SELF);
    const auto second = make_accelerator(parameters, MPI_COMM_SELF);
    for (int n = 0; n < 5; ++n) step(*whole, 10, 0.1 * n);
    io::CheckpointWriter writer(MPI_COMM_SELF, file);
    const IterateOrder order =
        IterateOrder::as_they_are(MPI_COMM_SELF, {std::vector<double>(40), std::vector<double>(40)});
    io::Archive saved(writer);
    whole->visit(saved, order);
    writer.close();
    io::CheckpointReader reader(MPI_COMM_SELF, file);
    io::Archive read(reader);
    second->visit(read, order);
    for (int n = 5; n < 9; ++n) {
      Iterate a, b;
      EXPECT_EQ(step(*whole, 10, 0.1 * n, 200, &a), step(*second, 10, 0.1 * n, 200, &b)) << int(type);
      EXPECT_EQ(a.unknown, b.unknown) << int(type);
      EXPECT_EQ(a.dependent, b.dependent) << int(type);
    }
  }
  std::filesystem::remove(file);
}

}  // namespace couplet::quasi_newton_test
