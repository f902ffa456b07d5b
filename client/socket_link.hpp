// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "link.hpp"

namespace couplet::wire {

/// Joins a job through the relay (`couplet relay 1`) whose file COUPLET_JOIN names, for participants launched
/// separately. Waits COUPLET_JOIN_WAIT seconds (60) for the file. Collective over `comm`, all processes of
/// the participant, as many as its relay has. Throws std::runtime_error.
std::unique_ptr<Link> link_by_socket(const std::string& file, const std::string& participant, MPI_Comm comm);

}  // namespace couplet::wire
