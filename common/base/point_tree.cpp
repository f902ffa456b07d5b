// SPDX-License-Identifier: Apache-2.0
#include "common/base/point_tree.hpp"

#include <Eigen/Geometry>
#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace couplet::base {

namespace {

struct Cloud {
  const std::vector<Vec3>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return points[i][Eigen::Index(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
constexpr double equal = 1 + 2e-9;  // of squares
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, Index>;
/// Indices and squared distances. The type of an item depends on nanoflann's version.
using Found = std::remove_reference_t<decltype(nanoflann::RadiusResultSet<double, Index>::m_indices_dists)>;

}  // namespace

struct PointTree::TreeState {
  Cloud cloud;
  Tree tree;
  explicit TreeState(const std::vector<Vec3>& points)
      : cloud{points}, tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    tree.buildIndex();
  }
};

PointTree::PointTree(const std::vector<Vec3>& points) : state_(std::make_unique<TreeState>(points)) {}
PointTree::~PointTree() = default;

std::vector<Index> PointTree::nearest(const Vec3& p, std::size_t k) const {
  const std::size_t all = state_->cloud.points.size();
  k = std::min(k, all);
  if (k == 0) return {};
  std::vector<Index> indices;
  std::vector<double> squares;
  // Queries more than k points until the last one is farther than the k-th.
  for (std::size_t n = std::min(k + 3, all);; n = std::min(2 * n, all)) {
    indices.resize(n), squares.resize(n);
    state_->tree.knnSearch(p.data(), n, indices.data(), squares.data());
    if (n == all || squares.back() > squares[k - 1] * equal) break;
  }
  for (std::size_t first = 0; first < k;) {
    std::size_t end = first + 1;
    while (end < indices.size() && squares[end] <= squares[first] * equal) ++end;
    std::sort(indices.begin() + std::ptrdiff_t(first), indices.begin() + std::ptrdiff_t(end));
    first = end;
  }
  indices.resize(k);
  return indices;
}

std::vector<Index> PointTree::closest(const Vec3& p) const {
  const std::size_t all = state_->cloud.points.size();
  static thread_local std::vector<double> squares;  // keeps its memory
  std::vector<Index> indices;
  for (std::size_t n = std::min<std::size_t>(2, all);; n = std::min(4 * n, all)) {
    indices.resize(n), squares.resize(n);
    state_->tree.knnSearch(p.data(), n, indices.data(), squares.data());
    while (!squares.empty() && squares.back() > squares.front() * equal) squares.pop_back();
    if (squares.size() < n || n == all) break;
  }
  indices.resize(squares.size());
  return indices;
}

std::vector<Index> PointTree::within(const Vec3& p, double distance) const {
  static thread_local Found found;  // keeps its memory
  // nanoflann excludes points at the limit. A distance of 0 must include the position itself.
  const double square = distance * distance * (1 + 1e-9) + std::numeric_limits<double>::min();
  nanoflann::RadiusResultSet<double, Index> set(square, found);
  state_->tree.radiusSearchCustomCallback(p.data(), set);
  std::vector<Index> indices;
  indices.reserve(found.size());
  for (const auto& item : found) indices.push_back(item.first);
  return indices;
}

NearestPoint<2> nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 d = b - a;
  const double square = d.squaredNorm();
  const double s = square > 0 ? std::clamp((x - a).dot(d) / square, 0.0, 1.0) : 0.0;
  const Vec3 place = a + s * d;
  return {{1 - s, s}, place, (x - place).norm()};
}

NearestPoint<3> nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 n = (b - a).cross(c - a);
  const double square = n.squaredNorm();
  if (square > 0) {
    const double u = (c - b).cross(x - b).dot(n) / square, v = (a - c).cross(x - c).dot(n) / square;
    if (u >= 0 && v >= 0 && u + v <= 1)
      return {
          {u, v, 1 - u - v}, u * a + v * b + (1 - u - v) * c, std::abs((x - a).dot(n)) / std::sqrt(square)};
  }
  const std::array<const Vec3*, 3> corner{&a, &b, &c};
  NearestPoint<3> best;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    const NearestPoint<2> edge = nearest_on_segment(*corner[i], *corner[next], x);
    if (i > 0 && edge.distance >= best.distance) continue;
    best = {{}, edge.place, edge.distance};
    best.weights[i] = edge.weights[0];
    best.weights[next] = edge.weights[1];
  }
  return best;
}

}  // namespace couplet::base
