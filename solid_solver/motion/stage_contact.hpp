// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/contact/pressing.hpp"

namespace couplet::solid {

/// The answer of the seat to what a stage solves for, w = x + beta v: with the conserving rule by the penetration at the end of the
/// step, else where the stage has its equilibrium. `now`: where the stage starts, `start`: where its step does. None: there is no
/// seat. Collective.
std::optional<Pressing> pressing_of(const SolidBody& body, const StageWork& work, const SolidState& now,
                                    const SolidState& start);

}  // namespace couplet::solid
