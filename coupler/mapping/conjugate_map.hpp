// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <Eigen/Core>

#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Map between a structure and a surface that moves with it and gives its load, used in both directions:
///   motion: B N A,   load: transpose of B N
/// A takes means of the motion over the structure's faces, N maps these to the surface's vertices, and B
/// takes means over the surface's faces. The work of the load on the mean motion is then equal on both sides
/// to round-off for any meshes. N is exact for linear fields, so the load keeps its force and moment. A is
/// omitted for motion given at faces, B for a load given at vertices. A load taken at vertices uses the
/// transpose of A. Collective; both sides must outlive it.
class ConjugateMap {
 public:
  using Place = coupling::Interface::Place;
  using Entries = std::vector<Transfer::Entry>;
  ConjugateMap(MPI_Comm comm, const Side& structure, const Side& surface, MappingParameters::Type type);
  /// Motion from the structure to the surface.
  Entries motion(Place from, Place to) const;
  /// Load from the surface to the structure.
  Entries load(Place from, Place to) const;

 private:
  /// N with A and B as required by the places.
  Entries between(Place structure, Place surface) const;
  MPI_Comm comm_;
  const Side *structure_, *surface_;
  Entries to_faces_, across_, to_surface_faces_;  // A, N, B
};

/// Part of a face that a face of the other surface covers: integrals over it of products of the face's corner
/// functions [m^2] (2-D: [m]). Each is 1 at its corner and linear along an edge (2-D) or over the triangles
/// of the face, which meet at the mean of the corners for more than three.
struct Cover {
  Index other;
  Eigen::MatrixXd products;
};

/// Cover of `face` by the faces of `other` among `candidates`, projected along its normal. Only faces that
/// look against it count, and of several layers the nearest. Uncovered parts go to the nearest face. The
/// products then sum to those over the whole face, except where a fold hides or duplicates something.
std::vector<Cover> covers(const coupling::Interface& surface, Index face, const coupling::Interface& other,
                          const std::vector<Index>& candidates);

}  // namespace couplet::coupler
