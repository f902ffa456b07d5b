// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

#include "common/base/error.hpp"

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

struct Neighbours {
  std::vector<Index> index;
  std::vector<double> distance;  // [m]
};

/// For each of `points` the nearest of `among`.
Neighbours nearest(const std::vector<Vec3>& points, const std::vector<Vec3>& among) {
  Neighbours result;
  const Cloud cloud{among};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  tree.buildIndex();
  for (const Vec3& p : points) {
    Index index = 0;
    double square = 0;
    tree.knnSearch(p.data(), 1, &index, &square);
    result.index.push_back(index);
    result.distance.push_back(std::sqrt(square));
  }
  return result;
}

double extent(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

/// Up to five points of `set` that are further than `tolerance` from every point of `other`.
std::string without_twin(const PointSet& set, const Neighbours& to_other, const PointSet& other,
                         double tolerance) {
  std::string list;
  std::size_t count = 0;
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    if (to_other.distance[i] <= tolerance) continue;
    const Vec3& p = set.points[i];
    if (++count <= 5)
      list += fmt::format("\n  ({:.9g}, {:.9g}, {:.9g}): the nearest is {:.3g} m away", p.x(), p.y(), p.z(),
                          to_other.distance[i]);
  }
  if (count == 0) return "";
  if (count > 5) list += fmt::format("\n  and {} more", count - 5);
  return fmt::format("{} of {} {} have no twin among the {} {} within {:.3g} m:{}", count, set.points.size(),
                     set.what, other.points.size(), other.what, tolerance, list);
}

void require_twins(const PointSet& from, const PointSet& to, const MappingParameters& parameters) {
  const double tolerance =
      parameters.tolerance.value_or(1e-6 * std::max(extent(from.points), extent(to.points)));
  const std::string advice =
      "\nGive both meshes the same points on the interface, or set `coupling.mapping.type: nearest`.";
  const Neighbours forth = nearest(to.points, from.points);
  if (const std::string text = without_twin(to, forth, from, tolerance); !text.empty())
    throw Error("{}{}", text, advice);
  const Neighbours back = nearest(from.points, to.points);
  if (const std::string text = without_twin(from, back, to, tolerance); !text.empty())
    throw Error("{}{}", text, advice);
  std::vector<Index> used = forth.index;
  std::sort(used.begin(), used.end());
  const auto twice = std::adjacent_find(used.begin(), used.end());
  if (twice == used.end() && from.points.size() == to.points.size()) return;
  const Vec3& p = from.points[twice == used.end() ? 0 : *twice];
  throw Error(
      "Several {} lie within {:.3g} m of each other or of the same one of the {}, for instance near ({:.9g}, "
      "{:.9g}, "
      "{:.9g}): the twins are not clear. Set a smaller `coupling.mapping.tolerance`.",
      to.what, tolerance, from.what, p.x(), p.y(), p.z());
}

}  // namespace

Mapping::Mapping(Kind kind, const PointSet& from, const PointSet& to, const MappingParameters& parameters)
    : n_from_(from.points.size()), n_to_(to.points.size()) {
  if (n_from_ == 0 || n_to_ == 0)
    throw Error(
        "There are {} {} and {} {}: an interface needs some on both sides. Check which patches are of type "
        "interface.",
        n_from_, from.what, n_to_, to.what);
  if (parameters.type == MappingParameters::Type::matched) require_twins(from, to, parameters);
  const Neighbours found = nearest(to.points, from.points);
  for (std::size_t i = 0; i < n_to_; ++i) links_.push_back({found.index[i], Index(i), 1});
  if (kind == Kind::conservative) share_out(from, to);
  for (const Link& link : links_) {
    const double d = (from.points[link.source] - to.points[link.target]).norm();
    max_distance_ = std::max(max_distance_, d);
    mean_distance_ += d / double(links_.size());
  }
  summary_ = fmt::format("{} {} to {} {}, distance at most {:.3g} m, mean {:.3g} m", n_from_, from.what,
                         n_to_, to.what, max_distance_, mean_distance_);
}

/// Shares of the targets that a source is nearest to, by their size; a source that is nearest to no target
/// gives all to its own nearest one. So a finer target takes smooth loads and a coarser one takes all of
/// them.
void Mapping::share_out(const PointSet& from, const PointSet& to) {
  const auto size = [&](Index target) { return to.sizes.empty() ? 1.0 : to.sizes[target]; };
  std::vector<double> total(n_from_, 0.);
  for (const Link& link : links_) total[link.source] += size(link.target);
  for (Link& link : links_) link.share = size(link.target) / total[link.source];
  const Neighbours back = nearest(from.points, to.points);
  for (std::size_t i = 0; i < n_from_; ++i)
    if (total[i] == 0) links_.push_back({Index(i), back.index[i], 1});
}

std::vector<double> Mapping::apply(const std::vector<double>& values, int components) const {
  assert(values.size() == n_from_ * std::size_t(components));
  std::vector<double> result(n_to_ * components, 0.);
  for (const auto& [source, target, share] : links_)
    for (int c = 0; c < components; ++c)
      result[std::size_t(target) * components + c] += share * values[std::size_t(source) * components + c];
  return result;
}

}  // namespace couplet
