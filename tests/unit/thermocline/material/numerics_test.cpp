// SPDX-License-Identifier: Apache-2.0
// Three diagonals: against products with the solution, for every size and for rows that hardly store anything.
#include "thermocline/material/numerics.hpp"
#include "tests/support/test.hpp"

namespace couplet::thermocline::tridiagonal_test {

TEST(Tridiagonal, solves_every_size_and_stiff_rows) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> digits(0, 1), decades(-6, 6);
  for (int n = 1; n <= 150; n += n < 8 ? 1 : 13)
    for (const double stored : {1., 1e-3, 1e-7}) {  // of what is conducted
      std::vector<double> a(n, 0), b(n), c(n, 0), x(n), r(n);
      for (int i = 0; i + 1 < n; ++i) c[i] = a[i + 1] = -std::pow(10, stored < 1 ? decades(random) : 0);
      for (int i = 0; i < n; ++i) {
        const double conducted = -a[i] - c[i];
        b[i] = conducted + stored * (conducted > 0 ? conducted : 1);
        x[i] = 500 + 100 * digits(random);
      }
      for (int i = 0; i < n; ++i)
        r[i] = b[i] * x[i] + (i > 0 ? a[i] * x[i - 1] : 0) + (i + 1 < n ? c[i] * x[i + 1] : 0);
      Tridiagonal matrix;
      matrix.resize(n);
      matrix.factorise(a.data(), b.data(), c.data());
      matrix.solve(r.data());
      double apart = 0;
      for (int i = 0; i < n; ++i) apart = std::max(apart, std::abs(r[i] - x[i]) / 600);
      EXPECT_LT(apart, 1e-15 / stored * 20) << n << " " << stored;
    }
}

}  // namespace couplet::thermocline::tridiagonal_test
