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

/// The mass per area that an interface of the fluid foresees, beside that of the plate behind it, density times thickness: what is
/// far above it is a slip of a unit, and diverges.
std::vector<std::string> doubts_of_wall_mass(const config::Document& document);

/// `contact.gap` of a structure: its seat is that of a gap of the fluid it is coupled with. Height, direction and opening
/// stand there once; they are set in the document as if they stood in the structure's `contact` as well. Gives what is
/// missing or stands twice.
std::vector<std::string> share_seats(config::Document& document);

}  // namespace couplet::app
