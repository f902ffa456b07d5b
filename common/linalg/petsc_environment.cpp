// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/petsc_environment.hpp"

#include <petscsys.h>

#include <exception>

#include "common/base/error.hpp"

namespace couplet::linalg {

// PETSc installs no signal handlers: it starts while the program runs, and removing them again (PetscPopSignalHandler) would
// take the program's own with them, and with these the stop that saves its state. Errors become exceptions (petsc_check.hpp);
// PETSc itself stays silent.
PetscEnvironment::PetscEnvironment(MPI_Comm program) {
  PETSC_COMM_WORLD = program;
  PetscErrorCode code = PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");
  if (code == 0) code = PetscInitializeNoArguments();
  if (code == 0) code = PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  if (code != 0) throw Error("PETSc could not be initialised.");
}

PetscEnvironment::~PetscEnvironment() {
  // PetscFinalize is collective: never during unwinding.
  if (std::uncaught_exceptions() == 0) PetscFinalize();
}

std::shared_ptr<void> petsc_environment(MPI_Comm program) {
  return std::make_shared<PetscEnvironment>(program);
}

}  // namespace couplet::linalg
