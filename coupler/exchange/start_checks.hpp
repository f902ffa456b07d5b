// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "coupler/exchange/partners.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Checks the configurations of programs with a preCICE adapter, which declare the digest of theirs and their
/// schemes (docs/protocol.md, initialise). Throws Error if they differ from each other or from the
/// configuration of the case (coupling.exchange.digest), or if the scheme or order has changed.
void check_introductions(const CouplingParameters& parameters, const std::vector<Partner>& partners);

/// Why these participants cannot continue from a checkpoint; empty if they can. Throws Error if checkpoints
/// are requested nevertheless (`checkpoint_interval` [s] above 0).
std::string without_state(double checkpoint_interval, const std::vector<Partner>& partners);

/// Checks that `coupling.fluid`, `structure` and `mesh` declare the data of their role (see
/// common/coupling/roles.hpp), and that fluid and structure have the same dimension. Throws Error.
void check_roles(const CouplingParameters& parameters, const std::vector<Side>& sides);

}  // namespace couplet::coupler
