// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace couplet::base {

/// The unit of a key that takes a difference of temperatures: a dimension apart from temperatures above absolute zero.
inline constexpr std::string_view kelvin_difference = "K difference";

/// Whether a number of this unit must not stand bare: two units in common use give it two plausible meanings. So it is
/// for temperatures (20 K or 20 degC), angles and speeds of rotation (0.5 rad or 0.5 deg); differences of temperatures
/// are the same in K and degC, everything else is in SI.
constexpr bool needs_unit(std::string_view unit) { return unit == "K" || unit == "rad" || unit == "rad/s"; }

}  // namespace couplet::base
