// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/config/load.hpp"

namespace couplet::app {

/// The mass per area that an interface of the fluid foresees, beside that of the plate behind it, density times thickness: what is
/// far above it is a slip of a unit, and diverges.
std::vector<std::string> doubts_of_wall_mass(const config::Document& document);

}  // namespace couplet::app
