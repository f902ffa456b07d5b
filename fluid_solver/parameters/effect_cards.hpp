// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/diagnostics/effects.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// What the cards look at: the parameters, and what the job around the fluid decides.
struct FluidScene {
  FluidParameters parameters;
  bool moving_mesh = false;  ///< the job has a mesh mover
  bool coupled = false;
};

using FluidCard = diagnostics::EffectCard<FluidScene>;
std::span<const FluidCard> fluid_effect_cards();

}  // namespace couplet::fluid
