// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

/// Corners of a face, as positions in the surface's own list of vertices.
std::span<const Index> corners(const coupling::Interface& surface, Index face);

/// Distance of a face's farthest corner from its centre [m].
double reach(const coupling::Interface& surface, Index face);

/// Weights of a face's corners for the mean of a field over the face. They sum to 1 and carry linear fields to
/// the centre that the participant gives: edges and triangles 1/n, faces of more corners by the areas of the
/// triangles about the mean of their corners, with the least change that meets the centre.
std::vector<double> corner_weights(const coupling::Interface& surface, Index face);

/// From values at the vertices to the means over the faces, over the ranks; `part`: this rank's part, corners by
/// position in the list of all vertices. Where the participant does not list corners: local interpolants. Collective.
std::vector<Transfer::Entry> vertices_to_faces(MPI_Comm comm, const coupling::Interface& part);

}  // namespace couplet::coupler
