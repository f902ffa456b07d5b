// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/config/section.hpp"

namespace couplet::config {

/// Plausible magnitudes of a key: "1e3 to 1e13 Pa". Empty if it has none.
std::string describe_plausible(const Key::Facts& facts);

/// Reason why the current value is implausible, or empty. Judges the largest component of a vector, the
/// largest and smallest entry of a list, and the values of a table, but no expression.
std::string doubt_of_magnitude(const Key::Facts& facts, const Slot& slot);

}  // namespace couplet::config
