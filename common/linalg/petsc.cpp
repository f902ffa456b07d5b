// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/petsc.hpp"

#include <petscsys.h>

#include <array>
#include <cmath>
#include <exception>
#include <utility>

#include "common/base/error.hpp"
#include "common/log/progress.hpp"

namespace couplet::linalg {

// PETSc installs no signal handlers. It starts while the program runs, so removing them later
// (PetscPopSignalHandler) would also remove the program's own, which save the state on a stop. Errors become
// exceptions (petsc_check()); PETSc prints nothing. It does not read .petscrc, which may lie beside a case from
// elsewhere and start a debugger. Options of a preconditioner that needed no coarse level are no mistake.
PetscEnvironment::PetscEnvironment(MPI_Comm program) {
  PETSC_COMM_WORLD = program;
  // PETSc keeps the pointers. It obeys -skip_petscrc only as an argument.
  static char name[] = "couplet", no_file[] = "-skip_petscrc", no_handler[] = "-no_signal_handler",
              options_left[] = "-options_left", no[] = "no";
  static std::array<char*, 6> words{name, no_file, no_handler, options_left, no, nullptr};
  int count = 5;
  char** all = words.data();
  PetscErrorCode code = PetscInitialize(&count, &all, nullptr, nullptr);
  if (code == 0) code = PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  if (code != 0) throw Error("PETSc could not be initialized.");
}

PetscEnvironment::~PetscEnvironment() {
  // PetscFinalize is collective and must not be called during unwinding.
  if (std::uncaught_exceptions() == 0) PetscFinalize();
}

std::shared_ptr<void> petsc_environment(MPI_Comm program) {
  return std::make_shared<PetscEnvironment>(program);
}

namespace {

// Iterations between restarts. GMRES must resolve a few dozen separated eigenvalues.
constexpr PetscInt before_restart = 100;

PetscErrorCode iteration_is_alive(KSP, PetscInt, PetscReal, void*) {
  log::alive();
  return 0;
}

}  // namespace

PetscGmres::PetscGmres(MPI_Comm comm, std::size_t n, LinearMap apply, LinearMap precondition)
    : apply_(std::move(apply)), precondition_(std::move(precondition)) {
  matrix_ = shell_matrix(comm, n, operator_);
  petsc_check(MatCreateVecs(matrix_, &correction_, &r_));
  petsc_check(KSPCreate(comm, &ksp_));
  petsc_check(KSPMonitorSet(ksp_, iteration_is_alive, nullptr, nullptr));
  petsc_check(KSPSetOperators(ksp_, matrix_, matrix_));
  petsc_check(KSPSetType(ksp_, KSPFGMRES));
  petsc_check(KSPSetPCSide(ksp_, PC_RIGHT));
  // An eigenvalue of 1e9 of a nearly singular preconditioner destroys a single orthogonalization.
  petsc_check(KSPGMRESSetCGSRefinementType(ksp_, KSP_GMRES_CGS_REFINE_IFNEEDED));
  petsc_check(KSPGMRESSetRestart(ksp_, before_restart));
  PC pc = nullptr;
  petsc_check(KSPGetPC(ksp_, &pc));
  petsc_check(PCSetType(pc, PCSHELL));
  petsc_check(PCShellSetContext(pc, &inverse_));
  petsc_check(PCShellSetApply(pc, precondition_shell));
}

PetscGmres::~PetscGmres() {
  if (!ksp_ || std::uncaught_exceptions() > 0) return;  // collective: not during unwinding
  KSPDestroy(&ksp_);
  VecDestroy(&r_);
  VecDestroy(&correction_);
  MatDestroy(&matrix_);
}

int PetscGmres::run(std::span<const double> r, std::span<double> x, double wanted, int most) {
  failure_ = nullptr;
  petsc_check(KSPSetTolerances(ksp_, 0, wanted, PETSC_DEFAULT, most));
  petsc_check(VecPlaceArray(r_, r.data()));
  const PetscErrorCode code = KSPSolve(ksp_, r_, correction_);
  petsc_check(VecResetArray(r_));
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  petsc_check(code);
  PetscInt iterations = 0;
  PetscReal size = 0;
  petsc_check(KSPGetIterationNumber(ksp_, &iterations));
  petsc_check(VecNorm(correction_, NORM_2, &size));
  if (!std::isfinite(size)) return static_cast<int>(iterations);
  const PetscScalar* correction = nullptr;
  petsc_check(VecGetArrayRead(correction_, &correction));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += correction[i];
  petsc_check(VecRestoreArrayRead(correction_, &correction));
  return static_cast<int>(iterations);
}

}  // namespace couplet::linalg
