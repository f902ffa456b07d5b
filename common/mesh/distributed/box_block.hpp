// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// A box of hexahedra, or of each cut into six tetrahedra: cells, points, patches and their order as make_box() has them.
struct BlockedBox {
  bool tetrahedra = false;
  std::array<GlobalIndex, 3> n{1, 1, 1};  ///< hexahedra a side
  Vec3 lower = Vec3::Zero(), upper = Vec3::Ones();
};

/// This rank's block of it; each rank makes its own, without a word to the others. Throws Error for no box.
MeshBlock box_block(MPI_Comm comm, const BlockedBox& box);

}  // namespace couplet::mesh
