// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"

namespace couplet::solid {

/// Adds the diagnostics of a Solid or ThermalSolid, which must outlive them.
void add_diagnostics(coupling::Participant& participant, diagnostics::Diagnostics& all);

}  // namespace couplet::solid
