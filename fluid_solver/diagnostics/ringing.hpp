// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

constexpr double ringing_limit = 0.05;

/// Tells whether the trapezoidal rule of a compressible fluid rings: waves of less than four steps a period, which it neither
/// resolves nor damps, make most of what the pressure changes. Of pressures p_0, p_1, p_2 of three steps these are
/// |p_0 - 2 p_1 + p_2| > |p_0 - p_2|, root mean squares over the volume. Returns the share
/// |p_0 - 2 p_1 + p_2| / (4 |p_0|) if it rings, else 0. Collective.
template <int D>
double ringing_share(const mesh::Mesh& mesh, const State<D>& state);

}  // namespace couplet::fluid
