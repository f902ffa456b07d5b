// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::thermocline {

inline constexpr double zero_celsius = 273.15;  // [K]
constexpr double celsius(double kelvin) { return kelvin - zero_celsius; }
constexpr double kelvin(double celsius) { return celsius + zero_celsius; }

}  // namespace couplet::thermocline
