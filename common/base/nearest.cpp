// SPDX-License-Identifier: Apache-2.0
#include "common/base/nearest.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace couplet::base {

Nearest<2> nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 d = b - a;
  const double square = d.squaredNorm();
  const double s = square > 0 ? std::clamp((x - a).dot(d) / square, 0.0, 1.0) : 0.0;
  const Vec3 place = a + s * d;
  return {{1 - s, s}, place, (x - place).norm()};
}

Nearest<3> nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 n = (b - a).cross(c - a);
  const double square = n.squaredNorm();
  if (square > 0) {
    const double u = (c - b).cross(x - b).dot(n) / square, v = (a - c).cross(x - c).dot(n) / square;
    if (u >= 0 && v >= 0 && u + v <= 1)
      return {
          {u, v, 1 - u - v}, u * a + v * b + (1 - u - v) * c, std::abs((x - a).dot(n)) / std::sqrt(square)};
  }
  const std::array<const Vec3*, 3> corner{&a, &b, &c};
  Nearest<3> best;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    const Nearest<2> edge = nearest_on_segment(*corner[i], *corner[next], x);
    if (i > 0 && edge.distance >= best.distance) continue;
    best = {{}, edge.place, edge.distance};
    best.weights[i] = edge.weights[0];
    best.weights[next] = edge.weights[1];
  }
  return best;
}

}  // namespace couplet::base
