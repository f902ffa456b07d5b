// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <string>

#include "common/coupling/messages.hpp"
#include "common/parallel/index_map.hpp"
#include "coupler/exchange/search.hpp"

namespace couplet::coupler {

/// One participant as the coupler knows it after `initialise`: this rank's part of its places, and how they
/// are cut over the coupler's ranks.
struct Side {
  std::string name;
  coupling::Interface interface;
  coupling::Starts vertices, faces;
  coupling::Surfaces surfaces;

  /// Collective; fills in ids where there are none.
  Side(MPI_Comm comm, std::string name, coupling::Interface interface);
  std::size_t entries(coupling::Interface::Place place) const {
    return place == coupling::Interface::Place::vertices ? interface.vertices.size()
                                                         : interface.face_centres.size();
  }
  /// The order of this rank's places by their numbers. Collective.
  parallel::GlobalOrder order(MPI_Comm comm, coupling::Interface::Place place) const;
  /// All places of a kind.
  PointSet places(coupling::Interface::Place place) const;
  /// Those where a datum is given, or taken.
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
