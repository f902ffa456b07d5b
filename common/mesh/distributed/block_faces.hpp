// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Face adjacency of the cells of the block.
struct BlockGraph {
  /// Two cells of the block that share a face.
  struct Pair {
    Index cell, other;
    std::int8_t face;  ///< position in `cell`, which has the smaller number
    bool bonded;
  };
  std::vector<Index> offset;
  std::vector<GlobalIndex> neighbours;
  GlobalIndex first_bonded = -1;  ///< number of the first boundary face that is a side of a bonded one, or -1
  std::vector<Pair> within;  ///< pairs on one rank, to avoid a second search; `neighbours` is empty there
  std::vector<Vec3> translation;  ///< of each pair of periodic patches, from the first to the second
};

/// Orients inverted cells, matches the faces of all blocks, joins periodic patches and fills the records of
/// the block's cells. The block's boundary elements are removed. Throws Error with the location of a cell
/// without volume, a boundary face in two patches, a boundary element that is not a boundary face, a
/// face of more than two cells, or a periodic face without a partner. Collective.
BlockGraph find_block_faces(MPI_Comm comm, MeshBlock& block);

}  // namespace couplet::mesh
