// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/conjugate_map.hpp"

#include "coupler/exchange/product.hpp"
#include "coupler/mapping/corner_weights.hpp"
#include "coupler/mapping/map_projection.hpp"
#include "coupler/mapping/surface_rows.hpp"
#include "coupler/mapping/surroundings.hpp"

namespace couplet::coupler {
namespace {

/// Where a side does not list the corners of its faces: local interpolants through the centres of the structure's.
std::vector<Transfer::Entry> without_corners(MPI_Comm comm, const Surroundings& structure,
                                             const Surroundings& surface, int dim) {
  const std::size_t k = dim == 2 ? 5 : 10;
  const PointSet vertices = surface.vertices();
  const Nearby near = nearby(comm, vertices.points, {}, k, structure.faces());
  std::vector<Transfer::Entry> entries;
  if (!vertices.points.empty())
    add_entries(local_interpolation(near.points, vertices.points, k), vertices.positions, near.positions,
                entries);
  return entries;
}

}  // namespace

ConjugateMap::ConjugateMap(MPI_Comm comm, const Side& structure, const Side& surface,
                           MappingParameters::Type type)
    : comm_(comm), structure_(&structure), surface_(&surface) {
  const Surroundings theirs(comm, structure.interface), ours(comm, surface.interface);
  const bool corners = theirs.has_corners() && ours.has_corners();
  if (type == MappingParameters::Type::projection) require_corners(corners);
  to_faces_ = vertices_to_faces(comm, structure.interface);
  to_surface_faces_ = vertices_to_faces(comm, surface.interface);
  across_ = corners ? faces_to_vertices(comm, structure.interface, surface.interface, type)
                    : without_corners(comm, theirs, ours, structure.interface.dim);
}

ConjugateMap::Entries ConjugateMap::between(Place structure, Place surface) const {
  Entries before;
  if (surface == Place::faces) before = product(comm_, surface_->vertices, to_surface_faces_, across_);
  const Entries& map = surface == Place::faces ? before : across_;
  return structure == Place::vertices ? product(comm_, structure_->faces, map, to_faces_) : map;
}

ConjugateMap::Entries ConjugateMap::motion(Place from, Place to) const { return between(from, to); }

ConjugateMap::Entries ConjugateMap::load(Place from, Place to) const { return transposed(between(to, from)); }

}  // namespace couplet::coupler
