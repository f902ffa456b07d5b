// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/app/job.hpp"
#include "common/coupling/participant.hpp"

namespace couplet::app {

/// The participant alone, from start to end. Returns the exit code.
int run_alone(const Job& job, coupling::Participant& participant);

/// The participant under a coupler's commands, until it is told to finalise.
int run_coupled(const Job& job, MPI_Comm coupler, coupling::Participant& participant);

}  // namespace couplet::app
