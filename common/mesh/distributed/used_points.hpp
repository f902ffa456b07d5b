// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Takes out the points that no cell and no boundary element has, renumbers the others and shares them out anew, as
/// drop_unused_points() of a whole mesh. Collective.
void drop_unused_points(MPI_Comm comm, MeshBlock& block);

}  // namespace couplet::mesh
