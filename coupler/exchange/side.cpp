// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/side.hpp"

#include <algorithm>

#include "common/parallel/collective.hpp"

namespace couplet::coupler {

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

PointBox::PointBox(MPI_Comm comm, const std::vector<Vec3>& points) {
  std::vector<Vec3> corners;
  for (const PointBox& box : parallel::all_gather(comm, std::vector<PointBox>{PointBox(points)}))
    if (!box.empty) corners.insert(corners.end(), {box.low, box.high});
  *this = PointBox(corners);
}

PointSet whole_set(PointSet set) {
  if (!set.starts.empty()) return set;
  for (std::size_t i = 0; i < set.points.size(); ++i) set.positions.push_back(GlobalIndex(i));
  set.ids = set.positions;
  set.starts = {0, GlobalIndex(set.points.size())};
  return set;
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
