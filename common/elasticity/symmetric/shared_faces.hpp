// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/symmetric/shared_edges.hpp"

namespace couplet::elastic {

/// The three-cornered flux faces in the order of SharedEdges: `n_mine` of this rank, then others'; `volume` [m^3] of
/// this rank's, 0 of the others. Empty in the plane.
struct SharedFaces {
  std::vector<Index> faces;
  std::vector<double> volume;
  std::size_t n_mine = 0;
};
SharedFaces shared_faces(const mesh::Mesh& mesh, const ElasticOperator& rows);

/// Stress of the edges: the mean of their faces' by the weights of their strain, see SharedEdges::at(). `stress`: per flux
/// face [Pa]. Collective.
void find_edge_stresses(const SharedFaces& shared, std::span<const Tensor3> stress, SharedEdges& edges);

/// What stands at an edge as a symmetric tensor.
Tensor3 edge_tensor(SharedEdges& edges, Index edge);

}  // namespace couplet::elastic
