// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/match_faces.hpp"

namespace couplet::mesh {

/// A boundary face that is joined with one of the other patch of its pair.
struct JoinedFace {
  GlobalIndex element, cell, other;  ///< boundary element, its cell, the cell beyond
  std::int8_t face;                  ///< position in the cell's shape
  std::int8_t side;                  ///< 0: on the first patch of the pair, 1: on the second
  int pair;                          ///< of MeshBlock::periodic
};

struct PeriodicFaces {
  std::vector<JoinedFace> joined;  ///< of this rank's boundary elements, ascending
  std::vector<Vec3> translation;   ///< of each pair, from its first patch to its second
};

/// Joins the faces of periodic patches, which meet by their centres at ranks that share out a direction among them. Throws
/// Error naming the place of a face without a partner. `first_element`: of this rank's block. Collective.
PeriodicFaces find_periodic_faces(MPI_Comm comm, const MeshBlock& block,
                                  const std::vector<BoundedCell>& bounded, GlobalIndex first_element);

}  // namespace couplet::mesh
