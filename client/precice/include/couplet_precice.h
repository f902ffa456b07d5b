/* SPDX-License-Identifier: Apache-2.0 */
/* One thing more than preCICE has, for parallel programs: in a job MPI_COMM_WORLD holds the processes of all programs, so
 * a program takes its own communicator, rank and size from here, before it constructs its precice::Participant. */
#ifndef COUPLET_PRECICE_H
#define COUPLET_PRECICE_H

#include <mpi.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The processes of this participant. The first call takes part in the start of the job; collective over them. */
MPI_Comm couplet_precice_comm(const char* participant);

#ifdef __cplusplus
}
#endif
#endif
