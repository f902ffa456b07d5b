// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/app/case/roll_call.hpp"
#include "common/config/load.hpp"

namespace couplet::app {

/// What is wrong with the roles that a coupled case gives to its participants: roles of nobody, participants
/// without a role, programs that cannot play theirs (see roles.hpp). Every program of a job finds the same, at its
/// roll call and by --check. `expected`: all that the case names.
std::vector<std::string> problems_of_roles(const config::Document& document,
                                           const std::vector<Expected>& expected);

}  // namespace couplet::app
