// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/petsc_environment.hpp"

#include <exception>

#include "common/linalg/lazy/petsc_calls.hpp"
#include "common/parallel/collective.hpp"

// Stands in petsc_calls.S; null where programs are linked to PETSc.
extern "C" [[gnu::weak]] const char couplet_petsc_is_lazy;

namespace couplet::linalg {

PetscEnvironment::PetscEnvironment(MPI_Comm program) {
  start_petsc_when_called(program);
  // On several ranks at once: starting is collective, and a mesh is cut by one rank alone.
  if (&couplet_petsc_is_lazy == nullptr || parallel::comm_size(program) > 1) start_petsc();
}

PetscEnvironment::~PetscEnvironment() {
  // PetscFinalize is collective: never during unwinding.
  if (std::uncaught_exceptions() == 0) stop_petsc();
}

std::shared_ptr<void> petsc_environment(MPI_Comm program) {
  return std::make_shared<PetscEnvironment>(program);
}

}  // namespace couplet::linalg
