// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "common/diagnostics/effects.hpp"
#include "plate_modal/model/parameters.hpp"

namespace couplet::plate {

/// What the cards look at: the parameters, and whether a coupler gives the forces of a fluid.
struct PlateScene {
  Parameters parameters;
  bool coupled = false;
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: not known
};

using PlateCard = diagnostics::EffectCard<PlateScene>;
/// All that a modal structure can simulate beside its modes, in the order in which it is told.
std::span<const PlateCard> plate_effect_cards();

}  // namespace couplet::plate
