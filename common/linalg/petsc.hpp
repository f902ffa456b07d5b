// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>
#include <petscksp.h>
#include <petscsys.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <memory>
#include <source_location>
#include <span>

#include "common/base/error.hpp"
#include "common/linalg/matrix.hpp"

namespace couplet::linalg {

/// Turns a PETSc error code into an Error that names PETSc's own message and our source line.
inline void petsc_check(PetscErrorCode code, std::source_location where = std::source_location::current()) {
  if (code == 0) return;
  const char* text = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(code, &text, &specific);
  throw SolveFailure("PETSc failed with code {} ({}; {}) at {}:{}.", int(code), text ? text : "no message",
                     specific ? specific : "no detail", where.file_name(), where.line());
}

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

/// An operator for PETSc, and the first exception that came out of it: none may pass through PETSc's frames.
struct ShellOperator {
  const LinearMap* apply = nullptr;
  std::exception_ptr* failure = nullptr;

  PetscErrorCode operator()(::Vec x, ::Vec y) const {
    const double* in = nullptr;
    double* out = nullptr;
    PetscInt n = 0;
    VecGetLocalSize(x, &n);
    VecGetArrayRead(x, &in);
    VecGetArray(y, &out);
    try {
      if (!*failure) (*apply)({in, std::size_t(n)}, {out, std::size_t(n)});
    } catch (...) {
      *failure = std::current_exception();
    }
    // After a failure the iteration goes on with something finite until it ends; its result is thrown away.
    if (*failure) std::copy_n(in, n, out);
    VecRestoreArray(y, &out);
    VecRestoreArrayRead(x, &in);
    return 0;
  }
};

inline PetscErrorCode multiply_shell(Mat a, ::Vec x, ::Vec y) {
  ShellOperator* op = nullptr;
  MatShellGetContext(a, &op);
  return (*op)(x, y);
}

inline PetscErrorCode precondition_shell(PC pc, ::Vec x, ::Vec y) {
  ShellOperator* op = nullptr;
  PCShellGetContext(pc, &op);
  return (*op)(x, y);
}

/// `op` by reference.
inline Mat shell_matrix(MPI_Comm comm, std::size_t n_owned, ShellOperator& op) {
  Mat mat = nullptr;
  const auto n = static_cast<PetscInt>(n_owned);
  petsc_check(MatCreateShell(comm, n, n, PETSC_DETERMINE, PETSC_DETERMINE, &op, &mat));
  petsc_check(MatShellSetOperation(mat, MATOP_MULT, reinterpret_cast<void (*)()>(multiply_shell)));
  return mat;
}

inline Mat symmetric_shell(MPI_Comm comm, std::size_t n_owned, ShellOperator& op) {
  Mat mat = shell_matrix(comm, n_owned, op);
  petsc_check(MatSetOption(mat, MAT_SYMMETRIC, PETSC_TRUE));
  return mat;
}

/// PETSc's flexible GMRES [saad1993] on an operator and a preconditioner that are only applied, the latter perhaps in single
/// precision. A few eigenvalues far from the others, on which BiCGStab spends hundreds of iterations, cost it a few dozen; it
/// keeps two vectors per iteration until it restarts after 100.
class PetscGmres {
 public:
  /// `n`: rows of this rank. Collective.
  PetscGmres(MPI_Comm comm, std::size_t n, LinearMap apply, LinearMap precondition);
  ~PetscGmres();
  PetscGmres(const PetscGmres&) = delete;
  PetscGmres& operator=(const PetscGmres&) = delete;

  /// Moves `x`, of residual `r`, until the residual is below `wanted` by the recurrence, the method breaks down or has made
  /// `most` iterations; returns how many it made. A correction that is not finite is left out. Throws what the operator or the
  /// preconditioner throws. Collective.
  int run(std::span<const double> r, std::span<double> x, double wanted, int most);

 private:
  const LinearMap apply_, precondition_;
  std::exception_ptr failure_;
  ShellOperator operator_{&apply_, &failure_}, inverse_{&precondition_, &failure_};
  Mat matrix_ = nullptr;
  KSP ksp_ = nullptr;
  ::Vec r_ = nullptr, correction_ = nullptr;
};

}  // namespace couplet::linalg
