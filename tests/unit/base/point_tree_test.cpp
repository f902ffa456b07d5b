// SPDX-License-Identifier: Apache-2.0
#include "common/base/point_tree.hpp"
#include "tests/support/test.hpp"

namespace couplet::nearest_test {
using namespace base;

const Vec3 a(0, 0, 0), b(2, 0, 0), c(0, 1, 0);

TEST(Nearest, OfASegment) {
  const auto middle = nearest_on_segment(a, b, Vec3(0.5, 3, 4));
  EXPECT_DOUBLE_EQ(middle.weights[1], 0.25);
  EXPECT_DOUBLE_EQ(middle.distance, 5);
  EXPECT_EQ(nearest_on_segment(a, b, Vec3(-1, 0, 0)).weights, (std::array<double, 2>{1, 0}));
  EXPECT_EQ(nearest_on_segment(a, b, Vec3(9, 1, 0)).place, b);
}

TEST(Nearest, OfASegmentWithoutLength) {
  const auto found = nearest_on_segment(b, b, Vec3(2, 3, 0));
  EXPECT_EQ(found.place, b);
  EXPECT_DOUBLE_EQ(found.distance, 3);
}

TEST(Nearest, OfATriangleWithin) {
  const auto found = nearest_on_triangle(a, b, c, Vec3(0.5, 0.25, -2));
  EXPECT_DOUBLE_EQ(found.weights[0], 0.5);
  EXPECT_DOUBLE_EQ(found.weights[1], 0.25);
  EXPECT_DOUBLE_EQ(found.weights[2], 0.25);
  EXPECT_DOUBLE_EQ(found.distance, 2);
}

TEST(Nearest, OfATriangleWithoutArea) {
  const auto line = nearest_on_triangle(a, b, 0.5 * b, Vec3(0.5, 1, 0));
  EXPECT_DOUBLE_EQ(line.distance, 1);
  EXPECT_NEAR((line.place - Vec3(0.5, 0, 0)).norm(), 0, 1e-15);
  EXPECT_DOUBLE_EQ(nearest_on_triangle(b, b, b, Vec3(2, 0, 7)).distance, 7);
}

// No place of the triangle lies nearer than the one found, and that place is the one of its weights.
TEST(Nearest, OfATriangleAgainstItsPlaces) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto point = [&] { return Vec3(any(random), any(random), any(random)); };
  for (int sample = 0; sample < 200; ++sample) {
    const Vec3 p = point(), q = point(), r = point(), x = 2 * point();
    const auto found = nearest_on_triangle(p, q, r, x);
    double least = std::numeric_limits<double>::max();
    constexpr int n = 60;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n - i; ++j)
        least = std::min(least, ((i * p + j * q + (n - i - j) * r) / n - x).norm());
    EXPECT_LE(found.distance, least + 1e-12);
    EXPECT_GE(found.distance, least - 3.5 / n);
    const Vec3 place = found.weights[0] * p + found.weights[1] * q + found.weights[2] * r;
    EXPECT_NEAR((place - found.place).norm(), 0, 1e-12);
    EXPECT_NEAR((x - place).norm(), found.distance, 1e-12);
    EXPECT_GE(*std::ranges::min_element(found.weights), 0);
  }
}

}  // namespace couplet::nearest_test
