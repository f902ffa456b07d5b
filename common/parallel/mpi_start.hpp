// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::parallel {

/// To be called before MPI_Init. Where nothing tells Open MPI which transports to use, neither its environment nor its
/// files, a program without a launcher is told to start no daemon, and one whose job is all on this machine to use
/// shared memory without probing networks. Both take a third of a second otherwise. Jobs over several machines are left
/// alone; other MPIs do not read these variables.
void prepare_mpi_start();

/// Whether Open MPI's own launcher watches over this process: a process that ends with another exit code than 0 then
/// ends the job.
bool has_open_mpi_launcher();

}  // namespace couplet::parallel
