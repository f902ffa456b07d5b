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

/// Converts a PETSc error code to an Error with PETSc's message and our source line.
inline void petsc_check(PetscErrorCode code, std::source_location where = std::source_location::current()) {
  if (code == 0) return;
  const char* text = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(code, &text, &specific);
  throw SolveFailure("PETSc failed with code {} ({}; {}) at {}:{}.", int(code), text ? text : "no message",
                     specific ? specific : "no detail", where.file_name(), where.line());
}

/// PETSc on the communicator of one program, within the lifetime of MPI. Sets PETSC_COMM_WORLD before
/// PetscInitialize and disables PETSc's signal handlers.
class PetscEnvironment {
 public:
  explicit PetscEnvironment(MPI_Comm program);
  ~PetscEnvironment();
  PetscEnvironment(const PetscEnvironment&) = delete;
  PetscEnvironment& operator=(const PetscEnvironment&) = delete;
};

/// Creates an environment that lives as long as the returned pointer, for Program::environment.
std::shared_ptr<void> petsc_environment(MPI_Comm program);

/// Operator for PETSc that stores its first exception, because none may pass through PETSc's frames.
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
    // After a failure the iteration needs finite values until it ends. Its result is discarded.
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

/// Creates a shell matrix that keeps a reference to `op`.
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

/// PETSc's flexible GMRES [saad1993] with a matrix-free operator and preconditioner, possibly in single
/// precision. It needs a few dozen iterations for a few separated eigenvalues, on which BiCGStab needs
/// hundreds. It stores two vectors per iteration and restarts after 100.
class PetscGmres {
 public:
  /// `n` is the number of rows of this rank. Collective.
  PetscGmres(MPI_Comm comm, std::size_t n, LinearMap apply, LinearMap precondition);
  ~PetscGmres();
  PetscGmres(const PetscGmres&) = delete;
  PetscGmres& operator=(const PetscGmres&) = delete;

  /// Improves `x` with residual `r` until the recursive residual is below `wanted`, the method breaks down or
  /// `most` iterations are made. Returns their number. A correction that is not finite is omitted. Rethrows
  /// exceptions of operator and preconditioner. Collective.
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
