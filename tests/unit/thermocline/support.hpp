// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "tests/support/test.hpp"

namespace couplet::thermocline {

inline constexpr double hour = 3600, day = 24 * hour;  // [s]
inline constexpr double salt = 1501.5;                 // [J/(kg K)], table 5.1 of the thesis

/// A line as it is, where a test changes some lines of a file.
inline std::string same(int, std::string line) { return line; }

}  // namespace couplet::thermocline
