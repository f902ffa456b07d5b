// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"

namespace couplet::thermocline {

/// Adds the diagnostics of an element that make_element() made, which must outlive them.
void add_diagnostics(coupling::Participant& element, diagnostics::Diagnostics& all);

}  // namespace couplet::thermocline
