// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/app/case/roll_call.hpp"
#include "common/config/load.hpp"

namespace couplet::app {

/// Problems of the roles in a coupled case: unknown participants, participants without a role, programs that
/// cannot play theirs (see roles.hpp). Every program of a job finds the same ones, at its roll call and by
/// --check. `expected` holds all participants of the case.
std::vector<std::string> problems_of_roles(const config::Document& document,
                                           const std::vector<Expected>& expected);

/// Compares the wall mass per area that a fluid assumes at an interface with the density times thickness of
/// the plate behind it. A much larger value indicates a wrong unit, and the coupling would diverge.
std::vector<std::string> doubts_of_wall_mass(const config::Document& document);

/// Copies height, direction and opening of a fluid's gap to the coupled structure with `contact.gap`, whose
/// seat it is. The document then behaves as if they were set in `contact`. Returns missing or duplicate
/// settings.
std::vector<std::string> share_seats(config::Document& document);

}  // namespace couplet::app
