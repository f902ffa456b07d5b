// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/block_faces.hpp"
#include "common/mesh/distributed/surroundings.hpp"
#include "common/mesh/whole_mesh.hpp"

namespace couplet::mesh {

/// What of a mesh a rank makes its pieces of.
struct PieceSource {
  MPI_Comm comm;
  const MeshBlock& block;  ///< its cells may be gone
  const BlockGraph& graph;
};

/// The piece of the mesh that these cells are, with the faces of own cells and all boundary faces. Throws Error if cells
/// and boundary do not fit together. Collective.
WholeMesh make_piece(const PieceSource& source, const LocalCells& local);

}  // namespace couplet::mesh
