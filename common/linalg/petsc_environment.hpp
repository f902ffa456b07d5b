// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <memory>

namespace couplet::linalg {

/// PETSc on the communicator of one program. MPI must be up before and stay up until after.
/// PETSC_COMM_WORLD is set before PetscInitialize; PETSc's own signal handlers stay off.
class PetscEnvironment {
 public:
  explicit PetscEnvironment(MPI_Comm program);
  ~PetscEnvironment();
  PetscEnvironment(const PetscEnvironment&) = delete;
  PetscEnvironment& operator=(const PetscEnvironment&) = delete;
};

/// One that lives as long as what is returned: for Program::environment.
std::shared_ptr<void> petsc_environment(MPI_Comm program);

}  // namespace couplet::linalg
