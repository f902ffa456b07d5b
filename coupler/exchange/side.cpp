// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/side.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {

namespace {

const Neighbour none{std::numeric_limits<double>::infinity(), -1, std::numeric_limits<GlobalIndex>::max(), 0,
                     Vec3::Zero()};

/// Compares by distance; ties (to rounding) by the smaller id.
bool better(const Neighbour& a, const Neighbour& b) {
  const double equal = 1e-9 * std::max(a.distance, b.distance);
  if (std::isfinite(equal) && std::abs(a.distance - b.distance) <= equal) return a.id < b.id;
  return a.distance < b.distance;
}

std::vector<Neighbour> nearest_here(const std::vector<Vec3>& points, const PointSet& among) {
  std::vector<Neighbour> found(points.size(), none);
  if (among.points.empty()) return found;
  const base::PointTree tree(among.points);
  constexpr std::size_t candidates = 4;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Index candidate : tree.nearest(points[i], candidates)) {
      const auto j = std::size_t(candidate);
      const Neighbour here{(points[i] - among.points[j]).norm(), among.positions[j], among.ids[j],
                           among.sizes.empty() ? 1 : among.sizes[j], among.points[j]};
      if (better(here, found[i])) found[i] = here;
    }
  return found;
}

}  // namespace

const coupling::Interface::Datum* find_datum(const std::vector<coupling::Interface::Datum>& list,
                                             const std::string& name) {
  const auto found = std::ranges::find(list, name, &coupling::Interface::Datum::name);
  return found == list.end() ? nullptr : &*found;
}

const std::vector<double>& values_of(const coupling::Exchange& data, const std::string& name) {
  static const std::vector<double> none;
  const auto found = data.find(name);
  return found == data.end() ? none : found->second;
}

PointBox::PointBox(const std::vector<Vec3>& points) : empty(points.empty()) {
  if (!empty) low = high = points.front();
  for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
}

PointSet whole_set(PointSet set) {
  if (!set.starts.empty()) return set;
  for (std::size_t i = 0; i < set.points.size(); ++i) set.positions.push_back(GlobalIndex(i));
  set.ids = set.positions;
  set.starts = {0, GlobalIndex(set.points.size())};
  return set;
}

std::vector<Neighbour> nearest(MPI_Comm comm, const std::vector<Vec3>& points, const PointSet& among) {
  if (parallel::comm_size(comm) == 1) return nearest_here(points, among);
  // Asks for a point in boxes nearer than the farthest corner of every box.
  const std::vector<PointBox> all = parallel::all_gather(comm, std::vector<PointBox>{PointBox(among.points)});
  std::vector<std::vector<Vec3>> ask(all.size());
  std::vector<std::vector<std::size_t>> asked(all.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double bound = std::numeric_limits<double>::infinity();
    for (const PointBox& box : all)
      if (!box.empty) bound = std::min(bound, box.furthest(points[i]));
    for (std::size_t r = 0; r < all.size(); ++r)
      if (!all[r].empty && all[r].nearest(points[i]) <= bound * (1 + 1e-9)) {
        ask[r].push_back(points[i]);
        asked[r].push_back(i);
      }
  }
  std::vector<std::vector<Neighbour>> answers;
  for (const auto& questions : parallel::all_to_all(comm, ask))
    answers.push_back(nearest_here(questions, among));
  const auto replies = parallel::all_to_all(comm, answers);
  std::vector<Neighbour> found(points.size(), none);
  for (std::size_t r = 0; r < replies.size(); ++r)
    for (std::size_t k = 0; k < replies[r].size(); ++k)
      if (better(replies[r][k], found[asked[r][k]])) found[asked[r][k]] = replies[r][k];
  return found;
}

int most_followers(MPI_Comm comm, const std::vector<Neighbour>& found, const coupling::Starts& starts) {
  std::vector<std::vector<GlobalIndex>> used(std::size_t(parallel::comm_size(comm)));
  for (const Neighbour& n : found)
    used[std::size_t(coupling::owner_of(starts, n.position))].push_back(n.position);
  std::vector<GlobalIndex> mine;
  for (const auto& part : parallel::all_to_all(comm, used)) mine.insert(mine.end(), part.begin(), part.end());
  std::ranges::sort(mine);
  int most = 0;
  for (std::size_t i = 0; i < mine.size();) {
    const std::size_t first = i;
    while (i < mine.size() && mine[i] == mine[first]) ++i;
    most = std::max(most, int(i - first));
  }
  return int(parallel::max(comm, double(most)));
}

Side::Side(MPI_Comm comm, std::string its_name, coupling::Interface its_interface)
    : name(std::move(its_name)), interface(std::move(its_interface)) {
  const auto cut = [&](std::size_t n, std::vector<GlobalIndex>& ids) {
    const coupling::Starts starts =
        coupling::starts_of(parallel::all_gather(comm, std::vector<GlobalIndex>{GlobalIndex(n)}));
    if (ids.empty())
      for (std::size_t i = 0; i < n; ++i)
        ids.push_back(starts[std::size_t(parallel::comm_rank(comm))] + GlobalIndex(i));
    return starts;
  };
  vertices = cut(interface.vertices.size(), interface.vertex_ids);
  faces = cut(interface.face_centres.size(), interface.face_ids);
  rank_ = std::size_t(parallel::comm_rank(comm));
}

parallel::GlobalOrder Side::order(MPI_Comm comm, coupling::Interface::Place place) const {
  const auto& ids = place == coupling::Interface::Place::vertices ? interface.vertex_ids : interface.face_ids;
  return parallel::GlobalOrder::by_numbers(comm, ids, ids.size());
}

PointSet Side::places(coupling::Interface::Place place) const {
  const bool at_vertices = place == coupling::Interface::Place::vertices;
  PointSet set;
  set.what = (at_vertices ? "vertices of '" : "faces of '") + name + "'";
  set.points = at_vertices ? interface.vertices : interface.face_centres;
  set.surface = &interface;
  set.place = place;
  set.ids = at_vertices ? interface.vertex_ids : interface.face_ids;
  set.starts = at_vertices ? vertices : faces;
  for (std::size_t i = 0; i < set.points.size(); ++i)
    set.positions.push_back(set.starts[rank_] + GlobalIndex(i));
  if (!at_vertices)
    for (const Vec3& area : interface.face_areas) set.sizes.push_back(area.norm());
  return set;
}

PointSet Side::places_of(const coupling::Interface::Datum& datum,
                         const std::map<std::string, int>& surface_of) const {
  PointSet all = places(datum.place);
  const auto surface = surface_of.find(datum.name);
  if (surface == surface_of.end()) return all;
  PointSet part{all.what + " on the mesh of '" + datum.name + "'",
                {},
                {},
                all.surface,
                {},
                {},
                all.starts,
                all.place,
                true};
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (surfaces.of_vertex[i] != surface->second) continue;
    part.points.push_back(all.points[i]);
    part.positions.push_back(all.positions[i]);
    part.ids.push_back(all.ids[i]);
  }
  return part;
}

}  // namespace couplet::coupler
