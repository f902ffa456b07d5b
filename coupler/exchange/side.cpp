// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/side.hpp"

#include "common/parallel/collective.hpp"

namespace couplet::coupler {

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
