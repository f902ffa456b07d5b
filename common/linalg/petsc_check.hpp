// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscsys.h>

#include <source_location>

#include "common/base/error.hpp"

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

}  // namespace couplet::linalg
