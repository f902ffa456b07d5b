// SPDX-License-Identifier: Apache-2.0
#include "coupler/point_tree.hpp"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

namespace couplet {
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

PointTree::Found PointTree::nearest(const Vec3& p) const {
  Found found;
  double square = 0;
  state_->tree.knnSearch(p.data(), 1, &found.index, &square);
  found.distance = std::sqrt(square);
  return found;
}

std::vector<Index> PointTree::nearest(const Vec3& p, std::size_t k) const {
  k = std::min(k, state_->cloud.points.size());
  std::vector<Index> indices(k);
  std::vector<double> squares(k);
  const std::size_t found = state_->tree.knnSearch(p.data(), k, indices.data(), squares.data());
  indices.resize(found);
  return indices;
}

}  // namespace couplet
