// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/config/section.hpp"

namespace couplet::config {

/// "1e3 to 1e13 Pa", the plausible magnitudes of a key; empty if it has none.
std::string describe_plausible(const Key::Facts& facts);

/// Why the value now in the member is implausible; empty if it is not. A vector is judged by its largest component, a
/// list by its largest and smallest entry, a table by its values; an expression is not judged.
std::string doubt_of_magnitude(const Key::Facts& facts, const Slot& slot);

}  // namespace couplet::config
