// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "coupler/exchange/partners.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Programs on preCICE's interface read their configuration themselves and introduce themselves by its digest and their schemes
/// (docs/protocol.md, initialise). Throws Error where two read different ones, or where the case was made of one
/// (coupling.exchange.digest) and they read another, or its scheme or order is no longer that of the configuration.
void check_introductions(const CouplingParameters& parameters, const std::vector<Partner>& partners);

/// Why a job with these participants cannot continue from a checkpoint; empty: it can. Throws Error where the case wants checkpoints all
/// the same (`checkpoint_interval` [s] above 0).
std::string without_state(double checkpoint_interval, const std::vector<Partner>& partners);

/// Of `coupling.fluid`, `structure` and `mesh`: what each announces must be what its role asks for (see
/// common/coupling/roles.hpp); fluid and structure have the same dimension. Throws Error.
void check_roles(const CouplingParameters& parameters, const std::vector<Side>& sides);

}  // namespace couplet::coupler
