// SPDX-License-Identifier: Apache-2.0
// Usage: solvers matrix FOLDER HOW | solvers solid FOLDER HOW case.yaml [--set ...]. See system.hpp.
#include <cstdio>
#include <cstring>

#include "benchmarks/linalg/system.hpp"
#include "common/base/error.hpp"
#include "common/linalg/petsc.hpp"

int main(int argc, char** argv) {
  if (argc >= 5 && std::strcmp(argv[1], "solid") == 0) {
    const std::string folder = argv[2], how = argv[3];
    argv[3] = argv[0];
    return couplet::benchmark::run_solid(folder, how, argc - 3, argv + 3);
  }
  if (argc != 4 || std::strcmp(argv[1], "matrix") != 0) {
    std::fprintf(stderr, "solvers matrix FOLDER HOW | solvers solid FOLDER HOW case.yaml [--set ...]\n");
    return 2;
  }
  MPI_Init(&argc, &argv);
  int code = 1;
  try {
    const couplet::linalg::PetscEnvironment environment(MPI_COMM_WORLD);
    code = couplet::benchmark::run_matrix(argv[2], argv[3]);
  } catch (const couplet::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
  return code;
}
