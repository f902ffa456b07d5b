// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/config/load.hpp"

namespace couplet::app {

/// `contact.gap` of a structure: its seat is that of a gap of the fluid it is coupled with. Height, direction and opening
/// stand there once; they are set in the document as if they stood in the structure's `contact` as well. Gives what is
/// missing or stands twice.
std::vector<std::string> share_seats(config::Document& document);

}  // namespace couplet::app
