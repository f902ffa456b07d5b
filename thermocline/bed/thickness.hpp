// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

namespace couplet::thermocline {

/// Thickness of the thermocline [m], equation 5.30 of [thesis]: the height between the critical temperatures
/// `cold` and `hot`; where one of them has left the bed, extrapolated with the mean gradient of the part that
/// is still there (both: with that of the whole bed). `z` centres of the cells, upward, `height` of the bed
/// [m], `temperature` a value a cell, `bottom` and `top` the temperatures there, all in the same unit.
/// Nothing if the bed is hot or cold all through.
std::optional<double> thermocline_thickness(std::span<const double> z, double height,
                                            std::span<const double> temperature, double cold, double hot);

}  // namespace couplet::thermocline
