// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::wire {

/// Selects shared memory for a job on one machine if the user made no choice. Call it before MPI_Init.
void choose_transports();

}  // namespace couplet::wire
