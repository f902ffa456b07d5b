// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/sparse_map.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/mapping/face_weights.hpp"

namespace couplet::coupler {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double rounding = 1 + 1e-9;

struct PointCount {
  PointBox box;
  std::size_t points;
};

/// Upper bound of the distance of the k-th nearest point from boxes; infinity if there are fewer points.
double bound_by_boxes(const std::vector<PointCount>& all, const Vec3& p, std::size_t k) {
  std::vector<std::pair<double, std::size_t>> far;
  for (const PointCount& c : all)
    if (c.points > 0) far.emplace_back(c.box.furthest(p), c.points);
  std::ranges::sort(far);
  std::size_t points = 0;
  for (const auto& [distance, n] : far)
    if ((points += n) >= k) return distance;
  return infinite;
}

/// Distance for each center that encloses k points: the smallest bound of the ranks with the nearest boxes,
/// or if they have fewer points, from the boxes.
std::vector<double> bounds(MPI_Comm comm, const std::vector<Vec3>& centres, std::size_t k,
                           const std::vector<PointCount>& all, const PointSet& among,
                           const base::PointTree* tree) {
  std::vector<std::vector<Vec3>> ask(all.size());
  std::vector<std::vector<std::size_t>> asked(all.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    double least = infinite;
    for (const PointCount& c : all)
      if (c.points > 0) least = std::min(least, c.box.nearest(centres[i]));
    // Boxes of list segments overlap, so the first box with a center may have no point near it.
    for (std::size_t r = 0; r < all.size(); ++r)
      if (all[r].points > 0 && all[r].box.nearest(centres[i]) <= least)
        ask[r].push_back(centres[i]), asked[r].push_back(i);
  }
  std::vector<std::vector<double>> answers;
  for (const auto& questions : parallel::all_to_all(comm, ask)) {
    auto& distances = answers.emplace_back();
    for (const Vec3& p : questions) {
      const bool enough = tree != nullptr && among.points.size() >= k;
      distances.push_back(enough ? (p - among.points[std::size_t(tree->nearest(p, k).back())]).norm()
                                 : infinite);
    }
  }
  const auto replies = parallel::all_to_all(comm, answers);
  std::vector<double> bound(centres.size(), infinite);
  for (std::size_t r = 0; r < replies.size(); ++r)
    for (std::size_t q = 0; q < replies[r].size(); ++q)
      bound[asked[r][q]] = std::min(bound[asked[r][q]], replies[r][q]);
  for (std::size_t i = 0; i < centres.size(); ++i)
    if (bound[i] == infinite) bound[i] = bound_by_boxes(all, centres[i], k);
  return bound;
}

/// Values at these positions (ascending) from their ranks; this rank's own without a message.
template <class Value, class Get>
std::vector<Value> fetch(MPI_Comm comm, const coupling::Starts& starts,
                         const std::vector<GlobalIndex>& positions, Get get) {
  const auto rank = std::size_t(parallel::comm_rank(comm));
  const GlobalIndex first = starts[rank];
  const auto own = std::ranges::lower_bound(positions, first),
             above = std::ranges::lower_bound(positions, starts[rank + 1]);
  std::vector<Value> all;
  const auto add_own = [&] {
    all.reserve(all.size() + std::size_t(above - own));
    for (auto p = own; p != above; ++p) get(std::size_t(*p - first), all);
  };
  if (parallel::comm_size(comm) == 1) return add_own(), all;
  std::vector<std::vector<GlobalIndex>> wanted(std::size_t(parallel::comm_size(comm)));
  const auto want = [&](auto begin, auto end) {
    for (auto p = begin; p != end; ++p) wanted[std::size_t(coupling::owner_of(starts, *p))].push_back(*p);
  };
  want(positions.begin(), own), want(above, positions.end());
  std::vector<std::vector<Value>> answers;
  for (const auto& list : parallel::all_to_all(comm, wanted)) {
    auto& values = answers.emplace_back();
    for (const GlobalIndex p : list) get(std::size_t(p - first), values);
  }
  const auto parts = parallel::all_to_all(comm, answers);
  for (std::size_t r = 0; r < parts.size(); ++r)
    if (r == rank)
      add_own();
    else
      all.insert(all.end(), parts[r].begin(), parts[r].end());
  return all;
}

/// Numbers within an ascending list of positions that contains a segment of this rank and some others.
class IdMap {
 public:
  /// Numbers all values in `positions`; this rank's segment starts at `first`.
  IdMap(GlobalIndex first, std::size_t own, const std::vector<GlobalIndex>& positions)
      : first_(first), number_(own, -1) {
    std::vector<GlobalIndex> others;
    for (const GlobalIndex p : positions)
      if (is_own(p))
        number_[std::size_t(p - first_)] = 0;
      else
        others.push_back(p);
    std::ranges::sort(others);
    others.erase(std::unique(others.begin(), others.end()), others.end());
    const auto above = std::ranges::lower_bound(others, first_);
    list.assign(others.begin(), above);
    for (std::size_t i = 0; i < own; ++i)
      if (number_[i] == 0) number_[i] = Index(list.size()), list.push_back(first_ + GlobalIndex(i));
    list.insert(list.end(), above, others.end());
  }
  Index operator()(GlobalIndex p) const {
    return is_own(p) ? number_[std::size_t(p - first_)]
                     : Index(std::ranges::lower_bound(list, p) - list.begin());
  }
  std::vector<GlobalIndex> list;  ///< ascending

 private:
  bool is_own(GlobalIndex p) const { return p >= first_ && p < first_ + GlobalIndex(number_.size()); }
  GlobalIndex first_;
  std::vector<Index> number_;
};

void sort_and_keep_one_each(std::vector<GlobalIndex>& list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

const Neighbour none{std::numeric_limits<double>::infinity(), -1, std::numeric_limits<GlobalIndex>::max(), 0,
                     Vec3::Zero()};

/// Returns true if `a` is nearer, or equally near (to rounding) with a smaller id.
bool better(const Neighbour& a, const Neighbour& b) {
  const double equal = 1e-9 * std::max(a.distance, b.distance);
  if (std::isfinite(equal) && std::abs(a.distance - b.distance) <= equal) return a.id < b.id;
  return a.distance < b.distance;
}

std::vector<Neighbour> nearest_here(const std::vector<Vec3>& points, const PointSet& among) {
  std::vector<Neighbour> found(points.size(), none);
  if (among.points.empty()) return found;
  const base::PointTree tree(among.points);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Index candidate : tree.closest(points[i])) {
      const auto j = std::size_t(candidate);
      const Neighbour here{(points[i] - among.points[j]).norm(), among.positions[j], among.ids[j],
                           among.sizes.empty() ? 1 : among.sizes[j], among.points[j]};
      if (better(here, found[i])) found[i] = here;
    }
  return found;
}

PointSet owned(MPI_Comm comm, const std::vector<Vec3>& points, const coupling::Starts& starts) {
  PointSet set;
  set.points = points, set.starts = starts;
  set.positions.resize(points.size());
  std::iota(set.positions.begin(), set.positions.end(), starts[std::size_t(parallel::comm_rank(comm))]);
  set.ids = set.positions;
  return set;
}

}  // namespace

PointSet nearby(MPI_Comm comm, const std::vector<Vec3>& centres, const std::vector<double>& reach,
                std::size_t k, const PointSet& among) {
  struct Ball {
    Vec3 centre;
    double radius;
  };
  struct NearbyPoint {
    GlobalIndex position, id;
    double size;
    Vec3 point;
  };
  const std::vector<PointCount> all =
      parallel::all_gather(comm, std::vector<PointCount>{{PointBox(among.points), among.points.size()}});
  std::optional<base::PointTree> tree;
  if (!among.points.empty()) tree.emplace(among.points);
  const std::vector<double> bound = bounds(comm, centres, k, all, among, tree ? &*tree : nullptr);
  std::vector<std::vector<Ball>> ask(all.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const double radius = (bound[i] + (reach.empty() ? 0 : 2 * reach[i])) * rounding;
    for (std::size_t r = 0; r < all.size(); ++r)
      if (all[r].points > 0 && all[r].box.nearest(centres[i]) <= radius)
        ask[r].push_back({centres[i], radius});
  }
  std::vector<std::vector<NearbyPoint>> answers;
  for (const auto& balls : parallel::all_to_all(comm, ask)) {
    std::vector<char> inside(among.points.size(), 0);
    for (const Ball& ball : balls)
      for (const Index i : tree->within(ball.centre, ball.radius)) inside[std::size_t(i)] = 1;
    auto& found = answers.emplace_back();
    for (std::size_t i = 0; i < inside.size(); ++i)
      if (inside[i])
        found.push_back(
            {among.positions[i], among.ids[i], among.sizes.empty() ? 1 : among.sizes[i], among.points[i]});
  }
  std::vector<NearbyPoint> found;
  for (const auto& part : parallel::all_to_all(comm, answers))
    found.insert(found.end(), part.begin(), part.end());
  std::ranges::sort(found, {}, &NearbyPoint::position);
  PointSet result;
  for (const NearbyPoint& f : found) {
    result.points.push_back(f.point), result.positions.push_back(f.position);
    result.ids.push_back(f.id), result.sizes.push_back(f.size);
  }
  return result;
}

std::vector<Neighbour> nearest(MPI_Comm comm, const std::vector<Vec3>& points, const PointSet& among) {
  if (parallel::comm_size(comm) == 1) return nearest_here(points, among);
  return nearest_here(points, nearby(comm, points, {}, 1, among));
}

Surroundings::Surroundings(MPI_Comm comm, const coupling::Interface& part) : comm_(comm), part_(part) {
  const auto cut = [&](std::size_t n) {
    return coupling::starts_of(parallel::all_gather(comm, std::vector<GlobalIndex>{GlobalIndex(n)}));
  };
  vertex_starts_ = cut(part.vertices.size()), face_starts_ = cut(part.face_centres.size());
  has_corners_ = face_starts_.back() > 0 &&
                 !parallel::any(comm, part.face_offset.size() != part.face_centres.size() + 1 &&
                                          !part.face_centres.empty());
}

PointSet Surroundings::vertices() const { return owned(comm_, part_.vertices, vertex_starts_); }
PointSet Surroundings::faces() const { return owned(comm_, part_.face_centres, face_starts_); }

double Surroundings::widest() const {
  const SurfacePart own = with(faces().positions);
  double most = 0;
  for (Index f = 0; f < Index(own.faces.size()); ++f) most = std::max(most, reach(own.surface, f));
  return parallel::max(comm_, most);
}

SurfacePart Surroundings::with(const std::vector<GlobalIndex>& faces) const {
  SurfacePart result;
  coupling::Interface& s = result.surface;
  s.dim = part_.dim;
  result.faces = faces;
  s.face_centres = fetch<Vec3>(comm_, face_starts_, faces,
                               [&](std::size_t f, auto& to) { to.push_back(part_.face_centres[f]); });
  s.face_areas = fetch<Vec3>(comm_, face_starts_, faces,
                             [&](std::size_t f, auto& to) { to.push_back(part_.face_areas[f]); });
  if (!has_corners_) return result;
  const auto counts = fetch<Index>(comm_, face_starts_, faces, [&](std::size_t f, auto& to) {
    to.push_back(part_.face_offset[f + 1] - part_.face_offset[f]);
  });
  const auto corners = fetch<GlobalIndex>(comm_, face_starts_, faces, [&](std::size_t f, auto& to) {
    to.insert(to.end(), part_.face_vertices.begin() + part_.face_offset[f],
              part_.face_vertices.begin() + part_.face_offset[f + 1]);
  });
  s.face_offset.push_back(0);
  for (const Index n : counts) s.face_offset.push_back(s.face_offset.back() + n);
  IdMap number(vertex_starts_[std::size_t(parallel::comm_rank(comm_))], part_.vertices.size(), corners);
  s.face_vertices.reserve(corners.size());
  for (const GlobalIndex c : corners) s.face_vertices.push_back(number(c));
  result.vertices = std::move(number.list);
  s.vertices = fetch<Vec3>(comm_, vertex_starts_, result.vertices,
                           [&](std::size_t v, auto& to) { to.push_back(part_.vertices[v]); });
  return result;
}

std::vector<GlobalIndex> Surroundings::faces_around(const std::vector<GlobalIndex>& vertices) const {
  struct Touch {
    GlobalIndex vertex, face;
  };
  // A face may be on another rank than its vertices: so the owner of each vertex receives its faces.
  const auto rank = std::size_t(parallel::comm_rank(comm_));
  std::vector<std::vector<Touch>> tell(std::size_t(parallel::comm_size(comm_)));
  for (std::size_t f = 0; f < part_.face_centres.size(); ++f)
    for (Index k = part_.face_offset[f]; k < part_.face_offset[f + 1]; ++k) {
      const GlobalIndex v = part_.face_vertices[std::size_t(k)];
      tell[std::size_t(coupling::owner_of(vertex_starts_, v))].push_back(
          {v, face_starts_[rank] + GlobalIndex(f)});
    }
  std::vector<Touch> known;
  for (const auto& part : parallel::all_to_all(comm_, tell))
    known.insert(known.end(), part.begin(), part.end());
  std::ranges::sort(known, [](const Touch& a, const Touch& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.face < b.face;
  });
  auto faces = fetch<GlobalIndex>(comm_, vertex_starts_, vertices, [&](std::size_t v, auto& to) {
    const GlobalIndex vertex = vertex_starts_[rank] + GlobalIndex(v);
    for (auto at = std::ranges::lower_bound(known, vertex, {}, &Touch::vertex);
         at != known.end() && at->vertex == vertex; ++at)
      to.push_back(at->face);
  });
  sort_and_keep_one_each(faces);
  return faces;
}

}  // namespace couplet::coupler
