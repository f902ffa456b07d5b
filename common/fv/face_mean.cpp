// SPDX-License-Identifier: Apache-2.0
#include "common/fv/face_mean.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace couplet::fv {
namespace {

/// Allowed change by a subdivision, relative to the largest value on the face.
constexpr double tolerance = 2e-3;
constexpr int least_levels_2d = 2, most_levels_2d = 10, most_levels_3d = 6;

/// Corner of a piece: the place, and the hats of the one or two corners of the face that the piece touches.
struct Corner {
  Vec3 x, hats;
};
/// Means over a piece of the function and of its products with these hats.
struct Means {
  Vec3 whole = Vec3::Zero();
  std::array<Vec3, 2> hat{Vec3::Zero(), Vec3::Zero()};

  void add(const Means& other, double factor) {
    whole += factor * other.whole;
    for (std::size_t i = 0; i < 2; ++i) hat[i] += factor * other.hat[i];
  }
  double largest() const {
    return std::max({whole.lpNorm<Eigen::Infinity>(), hat[0].lpNorm<Eigen::Infinity>(),
                     hat[1].lpNorm<Eigen::Infinity>()});
  }
};

Corner middle(const Corner& a, const Corner& b) { return {0.5 * (a.x + b.x), 0.5 * (a.hats + b.hats)}; }

/// Piece of a face: a segment (N = 2) or a triangle (N = 3).
template <std::size_t N>
struct FaceSimplex {
  using Corners = std::array<Corner, N>;
  static constexpr int children = N == 2 ? 2 : 4;

  const std::function<Vec3(const Vec3&)>& f;
  double largest = 0;  ///< value seen so far

  /// Gauss rule of N points, exact for products of linear functions.
  Means rule(const Corners& c) {
    constexpr double near_other = N == 2 ? 0.21132486540518713 : 1.0 / 6;
    Means means;
    for (std::size_t k = 0; k < N; ++k) {
      Corner at{(1 - N * near_other) * c[k].x, (1 - N * near_other) * c[k].hats};
      for (const Corner& other : c) at.x += near_other * other.x, at.hats += near_other * other.hats;
      const Vec3 value = f(at.x);
      largest = std::max(largest, value.template lpNorm<Eigen::Infinity>());
      means.add({value, {at.hats[0] * value, at.hats[1] * value}}, 1.0 / N);
    }
    return means;
  }

  /// Means over the piece, where `own` is its rule and `share` its share of the face.
  Means adaptive(const Corners& c, const Means& own, double share, int level) {
    std::array<Corners, children> child;
    const Corner m = middle(c[0], c[1]);
    if constexpr (N == 2) {
      child = {{{c[0], m}, {m, c[1]}}};
    } else {
      const Corner n = middle(c[1], c[2]), o = middle(c[2], c[0]);
      child = {{{c[0], m, o}, {m, c[1], n}, {o, n, c[2]}, {m, n, o}}};
    }
    std::array<Means, children> part;
    Means sum;
    for (std::size_t i = 0; i < children; ++i) sum.add(part[i] = rule(child[i]), 1.0 / children);
    Means change = sum;
    change.add(own, -1);
    // A jump cuts 2^level of the 4^level triangles, whose errors add up.
    const double weight = N == 2 ? share : std::sqrt(share);
    constexpr int least = N == 2 ? least_levels_2d : 1, most = N == 2 ? most_levels_2d : most_levels_3d;
    if (level + 1 >= most || (level + 1 >= least && weight * change.largest() <= tolerance * largest))
      return sum;
    sum = {};
    for (std::size_t i = 0; i < children; ++i)
      sum.add(adaptive(child[i], part[i], share / children, level + 1), 1.0 / children);
    return sum;
  }
};

}  // namespace

FaceMean mean_over_face(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index face,
                        const std::function<Vec3(const Vec3&)>& f) {
  const auto points = mesh.face_points[face];
  std::array<Vec3, 4> corners;
  for (std::size_t i = 0; i < points.size(); ++i) corners[i] = geometry.points[points[i]];
  return mean_over_face({corners.data(), points.size()}, geometry.face_centre[face], f);
}

FaceMean mean_over_face(std::span<const Vec3> corners, const Vec3& center,
                        const std::function<Vec3(const Vec3&)>& f) {
  const std::size_t n = corners.size();
  FaceMean mean;
  if (n == 2) {
    FaceSimplex<2> piece{f};
    for (std::size_t i = 0; i < n; ++i) {
      const FaceSimplex<2>::Corners half{{{center, Vec3::Zero()}, {corners[i], Vec3::UnitX()}}};
      const Means means = piece.adaptive(half, piece.rule(half), 0.5, 0);
      mean.whole += 0.5 * means.whole;
      mean.corner[i] = 0.5 * means.hat[0];
    }
    return mean;
  }
  std::array<double, 4> area{};
  double whole = 0;
  for (std::size_t i = 0; i < n; ++i)
    whole += area[i] = (corners[i] - center).cross(corners[(i + 1) % n] - center).norm();
  FaceSimplex<3> piece{f};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const double share = area[i] / whole;
    const FaceSimplex<3>::Corners triangle{
        {{center, Vec3::Zero()}, {corners[i], Vec3::UnitX()}, {corners[j], Vec3::UnitY()}}};
    const Means means = piece.adaptive(triangle, piece.rule(triangle), share, 0);
    mean.whole += share * means.whole;
    mean.corner[i] += share * means.hat[0];
    mean.corner[j] += share * means.hat[1];
  }
  return mean;
}

}  // namespace couplet::fv
