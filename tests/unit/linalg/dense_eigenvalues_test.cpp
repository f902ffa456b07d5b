// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/dense_eigenvalues.hpp"
#include "tests/support/test.hpp"

namespace couplet::dense_eigenvalues_test {

// A chain of n masses m between n + 1 springs k: 4 k / m sin^2(j pi / (2 n + 2)).
TEST(DenseEigenvalues, OfAChainOfMasses) {
  const int n = 12;
  const double k = 3, mass = 0.5;
  std::vector<double> stiffness(n * n, 0), inertia(n * n, 0);
  for (int i = 0; i < n; ++i) {
    stiffness[i * n + i] = 2 * k, inertia[i * n + i] = mass;
    if (i + 1 < n) stiffness[i * n + i + 1] = stiffness[(i + 1) * n + i] = -k;
  }
  const std::vector<double> values = linalg::symmetric_eigenvalues(stiffness, inertia, n);
  ASSERT_EQ(values.size(), std::size_t(n));
  for (int j = 1; j <= n; ++j)
    EXPECT_NEAR(values[j - 1], 4 * k / mass * std::pow(std::sin(j * std::numbers::pi / (2 * n + 2)), 2),
                1e-12);
}

TEST(DenseEigenvalues, OfATurnThatGrows) {
  // Twice a rotation by 60 degrees, and 5 on the diagonal.
  const double c = 1, s = std::sqrt(3.);
  auto values = linalg::general_eigenvalues({c, s, 0, -s, c, 0, 0, 0, 5}, 3);
  std::ranges::sort(values, {}, [](const auto& z) { return std::pair(z.real(), z.imag()); });
  ASSERT_EQ(values.size(), 3u);
  EXPECT_NEAR(std::abs(values[0] - std::complex(c, -s)), 0, 1e-13);
  EXPECT_NEAR(std::abs(values[1] - std::complex(c, s)), 0, 1e-13);
  EXPECT_NEAR(std::abs(values[2] - 5.), 0, 1e-13);
}

TEST(DenseEigenvalues, AMassThatIsNotPositiveIsRefused) {
  EXPECT_THROW(linalg::symmetric_eigenvalues({1, 0, 0, 1}, {1, 0, 0, -1}, 2), Error);
  EXPECT_TRUE(linalg::symmetric_eigenvalues({}, {}, 0).empty());
  EXPECT_TRUE(linalg::general_eigenvalues({}, 0).empty());
}

}  // namespace couplet::dense_eigenvalues_test
