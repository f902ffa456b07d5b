// SPDX-License-Identifier: Apache-2.0
// PETSc's start and end, in the shared module that brings its libraries (petsc_calls.hpp).
#include <petscksp.h>

/// PETSC_COMM_WORLD is set before PetscInitialize. PETSc installs no signal handlers: it starts while the program runs, and removing them
/// again (PetscPopSignalHandler) would take the program's own with them, and with these the stop that saves its state. Errors become
/// exceptions (see petsc_check.hpp); PETSc itself stays silent.
int couplet_petsc_start(MPI_Comm program) {
  PETSC_COMM_WORLD = program;
  PetscErrorCode code = PetscOptionsSetValue(NULL, "-no_signal_handler", "true");
  if (code == 0) code = PetscInitializeNoArguments();
  if (code == 0) code = PetscPushErrorHandler(PetscReturnErrorHandler, NULL);
  return (int)code;
}

void couplet_petsc_stop(void) { PetscFinalize(); }

const char* const* couplet_petsc_reasons(void) { return KSPConvergedReasons; }
