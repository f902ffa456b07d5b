// SPDX-License-Identifier: Apache-2.0
#include "common/base/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

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
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, Index>;

}  // namespace

struct PointTree::State {
  Cloud cloud;
  Tree tree;
  explicit State(const std::vector<Vec3>& points)
      : cloud{points}, tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    tree.buildIndex();
  }
};

PointTree::PointTree(const std::vector<Vec3>& points) : state_(std::make_unique<State>(points)) {}
PointTree::~PointTree() = default;

std::vector<Index> PointTree::nearest(const Vec3& p, std::size_t k) const {
  const std::size_t all = state_->cloud.points.size();
  k = std::min(k, all);
  if (k == 0) return {};
  constexpr double equal = 1 + 2e-9;  // of squares
  std::vector<Index> indices;
  std::vector<double> squares;
  // More than k, until the last one is further than the k-th.
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

std::vector<Index> PointTree::within(const Vec3& p, double distance) const {
  std::vector<std::pair<Index, double>> found;
  // nanoflann leaves out what is as far as the limit: a distance of 0 still holds the place itself.
  const double square = distance * distance * (1 + 1e-9) + std::numeric_limits<double>::min();
  state_->tree.radiusSearch(p.data(), square, found, {});
  std::vector<Index> indices;
  for (const auto& item : found) indices.push_back(item.first);
  return indices;
}

}  // namespace couplet::base
