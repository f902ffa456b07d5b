// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

namespace couplet::linalg {

/// PETSc, SLEPc, Scotch and LAPACK are a hundred libraries, which take longer to load than many a job to run. They come by one
/// shared module, which is opened by the first call of any of them (petsc_calls.S). PETSc is then started on this program's
/// ranks; null: it is not started any more.
void start_petsc_when_called(MPI_Comm program);

/// Now, unless it is up: on all ranks of the program, as on several ranks one may be the first to call. Ends the program if
/// the module cannot be opened.
void start_petsc();

/// The opposite, if it was started.
void stop_petsc();

}  // namespace couplet::linalg
