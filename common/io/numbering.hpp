// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/io/checkpoint.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Which cells, points and boundary faces each rank has, and in which order, as one number a rank in the checkpoint: the
/// arrays of a state are written rank by rank as they are, and the same counts in another order would be another state.
void write_numbering(CheckpointWriter& file, const mesh::Mesh& mesh);
/// Throws Error on all ranks if the mesh is shared out otherwise than when the checkpoint was written. Collective.
void check_numbering(CheckpointReader& file, const mesh::Mesh& mesh);

}  // namespace couplet::io
