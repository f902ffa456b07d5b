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

/// One map between a structure and a surface that moves with it and gives its load, used both ways:
///   motion: B N A,   load: transpose of B N
/// A: means of the motion over the structure's faces; N: from these to the surface's vertices; B: means over the
/// surface's faces. So the load's work on the means of both sides' motion is the same to rounding, on any meshes;
/// N carries linear fields exactly, so that the load keeps its force and moment. Where the motion is given at
/// faces A falls away, where the load is given at vertices B does, and a load taken at vertices goes on by the
/// transpose of A. Collective; both sides must outlive it.
class ConjugateMap {
 public:
  using Place = coupling::Interface::Place;
  using Entries = std::vector<Transfer::Entry>;
  ConjugateMap(MPI_Comm comm, const Side& structure, const Side& surface, MappingParameters::Type type);
  /// From the structure to the surface.
  Entries motion(Place from, Place to) const;
  /// From the surface to the structure.
  Entries load(Place from, Place to) const;

 private:
  /// N, behind it A, before it B, as the places are.
  Entries between(Place structure, Place surface) const;
  MPI_Comm comm_;
  const Side *structure_, *surface_;
  Entries to_faces_, across_, to_surface_faces_;  // A, N, B
};

/// The part of a face that a face of the other surface covers: integrals of the products of the corner functions
/// of the former over it [m^2] (2-D: [m]). These functions are 1 at their corner, linear along an edge (2-D) or
/// over the triangles of the face (more than three corners: about the mean of the corners).
struct Cover {
  Index other;
  Eigen::MatrixXd products;
};

/// How the faces of `other` among `candidates`, seen along the normal of `face`, cover it: those alone that look
/// against it and, where there are several layers, the nearest ones. What none covers goes to the nearest face. So
/// the products sum to those over all of the face, but for what a fold between faces hides or shows twice.
std::vector<Cover> covers(const coupling::Interface& surface, Index face, const coupling::Interface& other,
                          const std::vector<Index>& candidates);

}  // namespace couplet::coupler
