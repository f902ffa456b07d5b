// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::parallel {

/// Speeds up MPI_Init; call it before. If neither environment nor files select Open MPI's transports, a
/// program without a launcher starts no daemon, and a job on one machine uses shared memory without probing
/// networks. Both save a third of a second. Other jobs and other MPI libraries are not affected.
void prepare_mpi_start();

/// Returns true if Open MPI's own launcher watches this process, so that a nonzero exit code ends the job.
bool has_open_mpi_launcher();

}  // namespace couplet::parallel
