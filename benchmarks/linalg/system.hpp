// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <petscksp.h>

#include <string>
#include <vector>

#include "common/linalg/matrix.hpp"

namespace couplet::benchmark {

/// System A x = b, rows of this rank, and the residual norm at which Couplet stops.
struct System {
  MPI_Comm comm;
  linalg::LinearMap apply;  ///< as applied in Couplet
  std::vector<double> b, guess;
  double wanted;
  std::vector<double> solution;  ///< by Couplet; empty if unknown
};

/// Cost of a solver: CPU time and memory of all ranks together.
struct Result {
  int iterations = 0;
  double setup = 0, solve = 0, megabytes = 0;
  std::vector<double> x;
};

/// Solves by PETSc's KSP with these options. `p`: matrix for the preconditioner, nullptr to use `inverse`.
/// `a`: nullptr to apply Couplet's operator. Restarts until the true residual is small enough. Collective.
Result solve_by_petsc(const System& system, Mat a, Mat p, const linalg::LinearMap& inverse,
                      const std::string& options);

/// Prints one line of JSON with the relative residual and the distance from Couplet's solution. Collective.
void print(const System& system, const Result& result, const std::string& note);

::Vec vector_of(MPI_Comm comm, const std::vector<double>& values);
std::vector<double> values_of(::Vec v);
/// Reads or writes PETSc's binary format; `rows` of this rank.
std::vector<double> read_vector(MPI_Comm comm, const std::string& path, PetscInt rows);
void write_vector(MPI_Comm comm, const std::string& path, const std::vector<double>& values);

/// Runs a recorded matrix (record.c): how = "petsc OPTIONS", or "program METHOD" (name of a LinearMethod).
int run_matrix(const std::string& folder, const std::string& how);
/// Runs the first step of a solid case: how = "record", "program", "petsc OPTIONS" on the assembled matrix,
/// "krylov OPTIONS" of PETSc with Couplet's preconditioner, "cycle OPTIONS" with PETSc's multigrid.
int run_solid(const std::string& folder, const std::string& how, int argc, char** argv);

}  // namespace couplet::benchmark
