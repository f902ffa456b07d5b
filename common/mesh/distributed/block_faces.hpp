// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Which cells hang together by a face: per cell of the block its neighbours' numbers.
struct BlockGraph {
  std::vector<Index> offset;
  std::vector<GlobalIndex> neighbours;
  GlobalIndex first_bonded =
      -1;  ///< number of the first boundary face that is a side of a bonded one; -1: none
  std::vector<Vec3> translation;  ///< of each pair of periodic patches, from the first to the second
};

/// Turns inverted cells, matches the faces of all blocks, joins those of periodic patches and fills the records of the block's cells; the block's boundary
/// elements are gone afterwards. Throws what build_faces(), orient_cells() and
/// join_periodic() throw. Collective.
BlockGraph find_block_faces(MPI_Comm comm, MeshBlock& block);

}  // namespace couplet::mesh
