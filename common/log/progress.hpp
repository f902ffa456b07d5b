// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace couplet::log {

/// "0.4 s", "42 s", "3 min 20 s", "3 h 12 min", "2 d 5 h".
std::string format_duration(double seconds);

/// "ETA 3 h 12 min" if the rest runs as fast as what was done of `total` in `wall_seconds`; empty while
/// nothing was done.
std::string eta(double done, double total, double wall_seconds);

}  // namespace couplet::log
