// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/coupling/messages.hpp"
#include "common/coupling/participant.hpp"
#include "common/parallel/collective.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::coupler {

/// Datum of this name; nullptr if the list has none.
const coupling::Interface::Datum* find_datum(const std::vector<coupling::Interface::Datum>& list,
                                             const std::string& name);
/// Values by name; empty if there are none.
const std::vector<double>& values_of(const coupling::Exchange& data, const std::string& name);

/// Bounding box of points.
struct PointBox {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  bool empty = true;
  PointBox() = default;
  explicit PointBox(const std::vector<Vec3>& points);
  /// Around the points of all ranks. Collective.
  PointBox(MPI_Comm comm, const std::vector<Vec3>& points);
  double extent() const { return (high - low).norm(); }
  /// Distance [m] of a point of the box to `p`, at least and at most.
  double nearest(const Vec3& p) const { return (p - p.cwiseMax(low).cwiseMin(high)).norm(); }
  double furthest(const Vec3& p) const { return (p - low).cwiseAbs().cwiseMax((p - high).cwiseAbs()).norm(); }
};

/// Places of one side of the interface: this rank's part of a list distributed over the coupler's ranks.
struct PointSet {
  std::string what;  ///< for messages, for example "vertices of 'fluid'"
  std::vector<Vec3> points;
  std::vector<double> sizes{};  ///< of faces [m^2] (2-D: [m]), for shares; empty if equal
  /// Surface of these vertices or faces, this rank's part; for projection.
  const coupling::Interface* surface = nullptr;
  std::vector<GlobalIndex> positions{};  ///< of these points in the whole list
  std::vector<GlobalIndex> ids{};        ///< equal on any number of ranks; break ties
  coupling::Starts starts{};             ///< of the whole list
  coupling::Interface::Place place = coupling::Interface::Place::vertices;
  /// These points form a separate surface within `surface`, which maps by faces ignore.
  bool own_surface = false;
};
/// Sets positions, ids and starts of a list that is on one rank.
PointSet whole_set(PointSet set);

struct Neighbour {
  double distance;       ///< [m]; infinity if there is none
  GlobalIndex position;  ///< in the whole list
  GlobalIndex id;
  double size;  ///< of the neighbor, if its set has sizes
  Vec3 point;
};

/// Returns the largest number of points in `found`, over all ranks, that have the same neighbor. `starts`
/// belongs to the searched list. Collective.
int most_followers(MPI_Comm comm, const std::vector<Neighbour>& found, const coupling::Starts& starts);

/// Sends each item to the rank owner(item). Items are ordered by source rank and then as they were. Nothing
/// is sent if all are there already. Items are copied as bytes. Collective.
template <class Item, class Owner>
std::vector<Item> to_owners(MPI_Comm comm, std::vector<Item> items, const Owner& owner) {
  if (parallel::comm_size(comm) == 1) return items;
  const int rank = parallel::comm_rank(comm);
  const bool stay = std::ranges::all_of(items, [&](const Item& item) { return int(owner(item)) == rank; });
  if (!parallel::any(comm, !stay)) return items;
  const parallel::Parcels<Item> out = parallel::sort_by_rank(comm, items, owner);
  std::vector<Item>().swap(items);
  return parallel::exchange(comm, out).items;
}

/// Participant after `initialise`: this rank's part of its places, and their distribution over the coupler's
/// ranks.
struct Side {
  std::string name;
  coupling::Interface interface;
  coupling::Starts vertices, faces;
  coupling::Surfaces surfaces;

  /// Sets ids if there are none. Collective.
  Side(MPI_Comm comm, std::string name, coupling::Interface interface);
  std::size_t entries(coupling::Interface::Place place) const {
    return place == coupling::Interface::Place::vertices ? interface.vertices.size()
                                                         : interface.face_centres.size();
  }
  /// Order of this rank's places by their numbers. Collective.
  parallel::GlobalOrder order(MPI_Comm comm, coupling::Interface::Place place) const;
  /// All places of a kind.
  PointSet places(coupling::Interface::Place place) const;
  /// Places where a datum is given or taken.
  PointSet places_given(const coupling::Interface::Datum& datum) const {
    return places_of(datum, surfaces.gives);
  }
  PointSet places_taken(const coupling::Interface::Datum& datum) const {
    return places_of(datum, surfaces.takes);
  }

 private:
  PointSet places_of(const coupling::Interface::Datum& datum,
                     const std::map<std::string, int>& surface_of) const;
  std::size_t rank_ = 0;
};

}  // namespace couplet::coupler
