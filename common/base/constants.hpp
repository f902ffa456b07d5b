// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <numbers>

namespace couplet::base {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double degree = std::numbers::pi / 180;  // [rad]
/// Coordinate names in the column headings of tables.
inline constexpr std::array<const char*, 3> axis_letters{"x", "y", "z"};

}  // namespace couplet::base
