// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Which cells hang together by a face: per cell of the block its neighbours' numbers.
struct BlockGraph {
  /// Two cells of the block that share a face.
  struct Pair {
    Index cell, other;
    std::int8_t face;  ///< of `cell`, which has the smaller number
    bool bonded;
  };
  std::vector<Index> offset;
  std::vector<GlobalIndex> neighbours;
  GlobalIndex first_bonded =
      -1;  ///< number of the first boundary face that is a side of a bonded one; -1: none
  std::vector<Pair>
      within;  ///< on one rank, where they need not be found again; there are no `neighbours` there
  std::vector<Vec3> translation;  ///< of each pair of periodic patches, from the first to the second
};

/// Turns inverted cells, matches the faces of all blocks, joins those of periodic patches and fills the records of the block's
/// cells; the block's boundary elements are gone afterwards. Throws Error naming the place of a cell without volume, of a
/// boundary face in no patch or in two, of a boundary element that is no boundary face, of a face that more than two cells share,
/// or of a periodic face without a partner. Collective.
BlockGraph find_block_faces(MPI_Comm comm, MeshBlock& block);

}  // namespace couplet::mesh
