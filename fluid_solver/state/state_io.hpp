// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/io/checkpoint.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// All of a state, history included, bit for bit. Collective.
template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& state, bool compressible = false);
/// `at_rest`: the placement of a mesh that does not move; nullptr if the file says where the points are. `compressible`: the file
/// is that of such a fluid. Throws Error if the file does not fit the mesh. Collective.
template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool compressible = false);

}  // namespace couplet::fluid
