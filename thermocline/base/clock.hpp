// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::thermocline {

inline constexpr double seconds_an_hour = 3600, seconds_a_day = 86400;  // [s]
/// Moments that lie less than this before a full hour count as that hour [h].
inline constexpr double clock_rounding = 1e-9;

}  // namespace couplet::thermocline
