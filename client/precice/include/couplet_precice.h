/* SPDX-License-Identifier: Apache-2.0 */
/* Extension of preCICE's interface for parallel programs. In a job MPI_COMM_WORLD contains the processes of all programs,
 * so a program takes its communicator, rank and size from here before it constructs its precice::Participant. */
#ifndef COUPLET_PRECICE_H
#define COUPLET_PRECICE_H

#include <mpi.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Communicator of this participant's processes. The first call takes part in the start of the job. Collective. */
MPI_Comm couplet_precice_comm(const char* participant);

#ifdef __cplusplus
}
#endif
#endif
