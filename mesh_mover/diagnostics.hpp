// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/diagnostics/diagnostics.hpp"
#include "mesh_mover/mover.hpp"

namespace couplet::mesh_mover {

/// Adds the diagnostics of a mover, which must outlive them.
void add_diagnostics(const Mover& mover, diagnostics::Diagnostics& all);

}  // namespace couplet::mesh_mover
