// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Which directions of a point its patches hold or move. A point on several patches: `fixed` wins over what moves it,
/// and the plane of a patch that slides over both, so that corners stay closed; where planes meet at an edge (of one
/// patch or several) a point slides along the edge, where they meet at a corner it rests.
struct HeldPoints {
  /// Per local point: projector on the directions in which it is free (I inside the mesh, 0 where all is given) and
  /// on those in which it follows what is prescribed.
  std::vector<Tensor3> free, moved;
};

/// Throws Error if no patch holds or moves the mesh, or one is periodic. Collective.
HeldPoints find_held_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                            const Parameters& parameters);

}  // namespace couplet::mesh_mover
