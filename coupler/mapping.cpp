// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "coupler/map_projection.hpp"
#include "coupler/point_tree.hpp"

namespace couplet {
namespace {

struct Neighbours {
  std::vector<Index> index;
  std::vector<double> distance;  // [m]
};

/// For each of `points` the nearest of `among`.
Neighbours nearest(const std::vector<Vec3>& points, const std::vector<Vec3>& among) {
  Neighbours result;
  const PointTree tree(among);
  for (const Vec3& p : points) {
    const PointTree::Found found = tree.nearest(p);
    result.index.push_back(found.index);
    result.distance.push_back(found.distance);
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

SparseMap take_nearest(const Neighbours& found, std::size_t n_from) {
  SparseMap map;
  map.n_from = n_from;
  const double one = 1;
  for (const Index i : found.index) map.push_row({&i, 1}, {&one, 1});
  return map;
}

/// Shares of the targets that a source is nearest to, by their size; a source that is nearest to no target
/// gives all to its own nearest one. So a finer target takes smooth loads and a coarser one takes all of
/// them.
SparseMap share_out_nearest(const PointSet& from, const PointSet& to, const Neighbours& forth) {
  const Neighbours back = nearest(from.points, to.points);
  const auto size = [&](Index target) { return to.sizes.empty() ? 1.0 : to.sizes[target]; };
  std::vector<std::vector<Index>> targets(from.points.size());
  for (std::size_t t = 0; t < to.points.size(); ++t) targets[forth.index[t]].push_back(Index(t));
  SparseMap gather;
  gather.n_from = to.points.size();
  for (std::size_t s = 0; s < targets.size(); ++s) {
    if (targets[s].empty()) targets[s] = {back.index[s]};
    double total = 0;
    for (const Index t : targets[s]) total += size(t);
    std::vector<double> shares;
    for (const Index t : targets[s]) shares.push_back(size(t) / total);
    gather.push_row(targets[s], shares);
  }
  return gather.transposed();
}

/// Projection and radial functions.
SparseMap second_order(Mapping::Kind kind, const PointSet& from, const PointSet& to,
                       MappingParameters::Type type) {
  const bool projection = type == MappingParameters::Type::projection;
  const int dim = from.surface != nullptr ? from.surface->dim : 3;
  const std::size_t k = dim == 2 ? (projection ? 3 : 5) : (projection ? 5 : 10);
  if (kind == Mapping::Kind::conservative && from.surface != nullptr && to.surface != nullptr)
    return shared_out(*from.surface, *to.surface, k);
  const bool at_vertices = from.surface != nullptr && from.points.size() == from.surface->vertices.size();
  if (projection && at_vertices && kind == Mapping::Kind::consistent)
    return nearest_projection(*from.surface, to.points);
  return kind == Mapping::Kind::consistent ? local_interpolation(from.points, to.points, k)
                                           : local_interpolation(to.points, from.points, k).transposed();
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
  const bool nearest_only = parameters.type == MappingParameters::Type::matched ||
                            parameters.type == MappingParameters::Type::nearest;
  if (!nearest_only)
    map_ = second_order(kind, from, to, parameters.type);
  else if (kind == Kind::consistent)
    map_ = take_nearest(found, n_from_);
  else
    map_ = share_out_nearest(from, to, found);
  for (const double d : found.distance) {
    max_distance_ = std::max(max_distance_, d);
    mean_distance_ += d / double(n_to_);
  }
  summary_ = fmt::format("{} {} to {} {}, distance at most {:.3g} m, mean {:.3g} m", n_from_, from.what,
                         n_to_, to.what, max_distance_, mean_distance_);
}

}  // namespace couplet
