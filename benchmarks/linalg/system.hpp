// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscksp.h>

#include <string>
#include <vector>

#include "common/linalg/matrix.hpp"

namespace couplet::benchmark {

/// A x = b of a program, rows of this rank, and the norm of the residual at which the program stops.
struct System {
  MPI_Comm comm;
  linalg::LinearMap apply;  ///< as the program applies it
  std::vector<double> b, guess;
  double wanted;
  std::vector<double> solution;  ///< the program's own; empty: not known
};

/// What a solver took. Seconds of processor time and memory of all ranks together.
struct Result {
  int iterations = 0;
  double setup = 0, solve = 0, megabytes = 0;
  std::vector<double> x;
};

/// PETSc's KSP with these options. `p`: what the preconditioner is made from; null: `inverse` in its place. `a`: null: the
/// operator is applied by the program. Begins again until the true residual is small enough. Collective.
Result solve_by_petsc(const System& system, Mat a, Mat p, const linalg::LinearMap& inverse,
                      const std::string& options);

/// One line of JSON with the true residual over the wanted one and the distance from the program's solution. Collective.
void print(const System& system, const Result& result, const std::string& note);

::Vec vector_of(MPI_Comm comm, const std::vector<double>& values);
std::vector<double> values_of(::Vec v);
/// PETSc's binary file; `rows` of this rank.
std::vector<double> read_vector(MPI_Comm comm, const std::string& path, PetscInt rows);
void write_vector(MPI_Comm comm, const std::string& path, const std::vector<double>& values);

/// A recorded matrix (record.c): how = "petsc OPTIONS" or "program METHOD" with the name of a LinearMethod.
int run_matrix(const std::string& folder, const std::string& how);
/// The first step of a case of the solid: how = "record", "program", "petsc OPTIONS" on the assembled matrix, "krylov
/// OPTIONS" of PETSc with the program's operator and preconditioner, "cycle OPTIONS" of PETSc in the place of its multigrid.
int run_solid(const std::string& folder, const std::string& how, int argc, char** argv);

}  // namespace couplet::benchmark
