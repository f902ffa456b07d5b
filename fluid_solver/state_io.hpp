// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/io/checkpoint.hpp"
#include "fluid_solver/state.hpp"

namespace couplet::fluid {

/// All of a state, history included, bit for bit. Collective.
template <int D>
void write_state(CheckpointWriter& file, const State<D>& state);
/// Throws Error if the file does not fit the mesh. Collective.
template <int D>
State<D> read_state(CheckpointReader& file, const Mesh& mesh, bool moving);

}  // namespace couplet::fluid
