// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "link.hpp"

namespace couplet::wire {

/// Joins a job that was launched separately, through the relay whose file (`couplet relay 1`) the environment names in
/// COUPLET_JOIN; waits for that file COUPLET_JOIN_WAIT seconds (60). Collective over `comm`, the processes of the
/// participant, as many as its relay has. Throws std::runtime_error.
std::unique_ptr<Link> link_by_socket(const std::string& file, const std::string& participant, MPI_Comm comm);

}  // namespace couplet::wire
