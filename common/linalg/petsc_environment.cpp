// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/petsc_environment.hpp"

#include <petscsys.h>

#include <exception>

#include "common/base/error.hpp"

namespace couplet::linalg {

PetscEnvironment::PetscEnvironment(MPI_Comm program) {
  PETSC_COMM_WORLD = program;
  if (PetscInitializeNoArguments() != 0) throw Error("PETSc could not be initialised.");
  PetscPopSignalHandler();
  // Errors become exceptions (see linalg/petsc_check.hpp); PETSc itself stays silent.
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
}

PetscEnvironment::~PetscEnvironment() {
  // PetscFinalize is collective: never during unwinding.
  if (std::uncaught_exceptions() == 0) PetscFinalize();
}

std::shared_ptr<void> petsc_environment(MPI_Comm program) {
  return std::make_shared<PetscEnvironment>(program);
}

}  // namespace couplet::linalg
