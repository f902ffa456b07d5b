// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscksp.h>

#include <cstddef>
#include <exception>
#include <span>

#include "common/linalg/linear_map.hpp"
#include "common/linalg/shell_operator.hpp"

namespace couplet::linalg {

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
