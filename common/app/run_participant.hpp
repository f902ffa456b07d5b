// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "common/app/job.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"

namespace couplet::app {

/// Adds the diagnostics of an initialized participant; empty if it has none.
using Diagnose = std::function<void(coupling::Participant&, diagnostics::Diagnostics&)>;

/// Runs the participant alone from start to end. Returns the exit code.
int run_alone(const Job& job, coupling::Participant& participant, const Diagnose& diagnose = {});

/// Runs the participant under a coupler's commands until it is told to finalize.
int run_coupled(const Job& job, MPI_Comm coupler, coupling::Participant& participant,
                const Diagnose& diagnose = {});

}  // namespace couplet::app
