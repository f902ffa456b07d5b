// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscksp.h>

#include "common/linalg/linear_solver.hpp"

namespace couplet::linalg {

/// Sets the Krylov method and the preconditioner that a name stands for.
void choose_method(KSP ksp, PC pc, const SparseMatrix& matrix, LinearMethod method);

/// CHOLMOD's simplicial LDL^T: its two triangular solves cost a seventh of MUMPS's on a 2-D mesh. The
/// supernodal form factorises faster, but with supernodes this thin solves more slowly.
void choose_cholmod(PC pc);

}  // namespace couplet::linalg
