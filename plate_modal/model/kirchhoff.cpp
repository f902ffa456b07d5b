// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/midsurface.hpp"

#include <Eigen/LU>

namespace couplet::plate {
namespace {

using Row = Eigen::Matrix<double, 1, 9>;

/// Gradients of the area coordinates.
std::array<Vec2, 3> coordinate_gradients(const Triangle& x) {
  const double twice = 2 * area(x);
  std::array<Vec2, 3> g;
  for (int i = 0; i < 3; ++i) {
    const Vec2 opposite = x[(i + 2) % 3] - x[(i + 1) % 3];
    g[i] = Vec2(-opposite.y(), opposite.x()) / twice;
  }
  return g;
}

/// Slopes (two rows) at the midpoint of the edge opposite to vertex k: along the edge those of the cubic
/// through its ends, across it the mean of the ends [batoz1980].
Eigen::Matrix<double, 2, 9> middle_slopes(const Triangle& x, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double length = (x[j] - x[i]).norm();
  const Vec2 t = (x[j] - x[i]) / length, n(t.y(), -t.x());
  Row along = Row::Zero(), across = Row::Zero();
  along[3 * i] = -1.5 / length;
  along[3 * j] = 1.5 / length;
  for (const int end : {i, j})
    for (int c = 0; c < 2; ++c) {
      along[3 * end + 1 + c] = -0.25 * t[c];
      across[3 * end + 1 + c] = 0.5 * n[c];
    }
  return t * along + n * across;
}

/// Curvatures (w,xx  w,yy  2 w,xy) at the point with these area coordinates.
Eigen::Matrix<double, 3, 9> curvature(const std::array<Vec2, 3>& gradient,
                                      const std::array<Eigen::Matrix<double, 2, 9>, 3>& middle,
                                      const std::array<double, 3>& l) {
  Eigen::Matrix<double, 3, 9> b = Eigen::Matrix<double, 3, 9>::Zero();
  const auto add = [&](const Vec2& dn, const Eigen::Matrix<double, 2, 9>& slopes) {
    b.row(0) += dn.x() * slopes.row(0);
    b.row(1) += dn.y() * slopes.row(1);
    b.row(2) += dn.y() * slopes.row(0) + dn.x() * slopes.row(1);
  };
  for (int i = 0; i < 3; ++i) {
    Eigen::Matrix<double, 2, 9> corner = Eigen::Matrix<double, 2, 9>::Zero();
    corner(0, 3 * i + 1) = corner(1, 3 * i + 2) = 1;
    add((4 * l[i] - 1) * gradient[i], corner);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    add(4 * (l[j] * gradient[k] + l[k] * gradient[j]), middle[i]);
  }
  return b;
}

// Powers of the area coordinates in the cubic Bernstein basis: corners, edges (two at i, one at j), center.
constexpr std::array<std::array<int, 3>, 10> powers{{{3, 0, 0},
                                                     {0, 3, 0},
                                                     {0, 0, 3},
                                                     {2, 1, 0},
                                                     {2, 0, 1},
                                                     {1, 2, 0},
                                                     {0, 2, 1},
                                                     {1, 0, 2},
                                                     {0, 1, 2},
                                                     {1, 1, 1}}};

/// Bernstein coefficients of w from the nine unknowns.
Eigen::Matrix<double, 10, 9> cubic(const Triangle& x) {
  Eigen::Matrix<double, 10, 9> c = Eigen::Matrix<double, 10, 9>::Zero();
  for (int a = 0; a < 9; ++a) {
    int i = 0, j = -1;
    for (int v = 0; v < 3; ++v) {
      if (powers[a][v] >= 2) i = v;
      if (powers[a][v] == 1) j = v;
    }
    c(a, 3 * i) = 1;
    if (j < 0) continue;
    for (int d = 0; d < 2; ++d) c(a, 3 * i + 1 + d) = (x[j] - x[i])[d] / 3;
  }
  // Center coefficient for exact quadratic w.
  c.row(9) = c.middleRows(3, 6).colwise().sum() / 4 - c.topRows(3).colwise().sum() / 6;
  return c;
}

constexpr double binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value *= double(n - k + i) / i;
  return value;
}

/// Integral of products of Bernstein polynomials over a triangle of area 1.
Eigen::Matrix<double, 10, 10> bernstein_products() {
  Eigen::Matrix<double, 10, 10> m;
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < 10; ++b) {
      double product = 1;
      for (int v = 0; v < 3; ++v) product *= binomial(powers[a][v] + powers[b][v], powers[a][v]);
      m(a, b) = product / (binomial(6, 3) * binomial(8, 2));
    }
  return m;
}

}  // namespace

double area(const Triangle& x) {
  const Vec2 a = x[1] - x[0], b = x[2] - x[0];
  return 0.5 * (a.x() * b.y() - a.y() * b.x());
}

TriangleMatrix bending_stiffness(const Triangle& x, double rigidity, double nu) {
  Eigen::Matrix3d law;
  law << 1, nu, 0, nu, 1, 0, 0, 0, 0.5 * (1 - nu);
  const auto gradient = coordinate_gradients(x);
  const std::array middle{middle_slopes(x, 0), middle_slopes(x, 1), middle_slopes(x, 2)};
  TriangleMatrix k = TriangleMatrix::Zero();
  // Curvatures are linear, so edge midpoints integrate their products exactly.
  for (const std::array<double, 3>& l :
       {std::array{0., .5, .5}, std::array{.5, 0., .5}, std::array{.5, .5, 0.}}) {
    const auto b = curvature(gradient, middle, l);
    k += area(x) / 3 * rigidity * b.transpose() * law * b;
  }
  return k;
}

TriangleMatrix inertia(const Triangle& x, double density) {
  static const Eigen::Matrix<double, 10, 10> products = bernstein_products();
  const auto c = cubic(x);
  return density * area(x) * c.transpose() * products * c;
}

TriangleVector mean_deflection(const Triangle& x) { return cubic(x).colwise().sum().transpose() / 10; }

std::span<const CornerTriangle> pieces_of(std::size_t corners) {
  static constexpr std::array<CornerTriangle, 1> triangle{{{{0, 1, 2}, 1}}};
  static constexpr std::array<CornerTriangle, 4> quadrilateral{
      {{{0, 1, 2}, .5}, {{0, 2, 3}, .5}, {{0, 1, 3}, .5}, {{1, 2, 3}, .5}}};
  if (corners == 3) return triangle;
  return quadrilateral;
}

}  // namespace couplet::plate
