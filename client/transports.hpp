// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::wire {

/// Before MPI_Init: shared memory alone where all processes of the job sit on one machine and the user has not chosen.
void choose_transports();

}  // namespace couplet::wire
