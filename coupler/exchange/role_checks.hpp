// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Of `coupling.fluid`, `structure` and `mesh`: what each announces must be what its role asks for (see
/// common/coupling/roles.hpp); fluid and structure have the same dimension. Throws Error.
void check_roles(const CouplingParameters& parameters, const std::vector<Side>& sides);

}  // namespace couplet::coupler
