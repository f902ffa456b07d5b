// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <map>

#include "benchmarks/linalg/meter.hpp"
#include "benchmarks/linalg/system.hpp"
#include "common/base/error.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/petsc.hpp"

namespace couplet::benchmark {

using namespace linalg;
namespace {

// Number of repetitions, because one solve is shorter than the resolution of the CPU clock.
constexpr int repeated = 10;

LinearMethod method_of(const std::string& name) {
  static const std::map<std::string, LinearMethod> known{{"cg-direct", LinearMethod::cg_direct},
                                                         {"cg-multigrid", LinearMethod::cg_multigrid}};
  if (!known.contains(name)) throw Error("No method '{}': cg-single, cg-direct, cg-multigrid.", name);
  return known.at(name);
}

Mat read_matrix(MPI_Comm comm, const std::string& path, PetscInt rows) {
  PetscViewer file = nullptr;
  Mat a = nullptr;
  petsc_check(PetscViewerBinaryOpen(comm, path.c_str(), FILE_MODE_READ, &file));
  petsc_check(MatCreate(comm, &a));
  petsc_check(MatSetSizes(a, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
  petsc_check(MatSetType(a, MATAIJ));
  petsc_check(MatLoad(a, file));
  petsc_check(PetscViewerDestroy(&file));
  petsc_check(MatSetOption(a, MAT_SYMMETRIC, PETSC_TRUE));
  petsc_check(MatSetOption(a, MAT_SPD, PETSC_TRUE));
  return a;
}

/// Rows as Couplet builds them: triplets at fixed positions. `value`: entries in this order.
SparseMatrix program_matrix(MPI_Comm comm, Mat a, std::vector<double>& value) {
  PetscInt first = 0, end = 0;
  petsc_check(MatGetOwnershipRange(a, &first, &end));
  std::vector<GlobalIndex> row, column;
  value.clear();
  for (PetscInt i = first; i < end; ++i) {
    PetscInt n = 0;
    const PetscInt* index = nullptr;
    const PetscScalar* entry = nullptr;
    petsc_check(MatGetRow(a, i, &n, &index, &entry));
    for (PetscInt k = 0; k < n; ++k) {
      row.push_back(i);
      column.push_back(index[k]);
      value.push_back(entry[k]);
    }
    petsc_check(MatRestoreRow(a, i, &n, &index, &entry));
  }
  SparseMatrix matrix(comm, end - first, std::move(row), std::move(column));
  matrix.fill(value);
  return matrix;
}

/// `now`, `made`: entries of the matrix to solve, and of that for the preconditioner.
Result solve_by_program(const System& system, SparseMatrix& matrix, std::span<const double> now,
                        std::span<const double> made, LinearMethod method) {
  Result result;
  matrix.fill(made);
  const Meter whole(system.comm);
  LinearSolver solver("pressure", matrix, {.method = method});
  solver.restore({.is_due = false, .most_iterations = 500});
  result.setup = whole.seconds();
  matrix.fill(now);
  const double filled = whole.seconds();
  for (int i = 0; i < repeated; ++i) {
    result.x = system.guess;
    result.iterations = solver.solve(system.b, result.x, 0, system.wanted).iterations;
  }
  result.solve = (whole.seconds() - filled) / repeated;
  result.megabytes = whole.peak();
  return result;
}

}  // namespace

int run_matrix(const std::string& folder, const std::string& how) {
  MPI_Comm comm = MPI_COMM_WORLD;
  const std::string ranks = std::to_string(parallel::comm_size(comm));
  std::ifstream about(folder + "/about-" + ranks);
  System system{comm, {}, {}, {}, 0, {}};
  about >> system.wanted;
  PetscInt rows = 0;
  for (int r = 0; r <= parallel::comm_rank(comm); ++r) about >> rows;
  if (!about) throw Error("{} holds no system of {} ranks (record.c).", folder, ranks);
  const Mat a = read_matrix(comm, folder + "/A-" + ranks, rows),
            p = read_matrix(comm, folder + "/P-" + ranks, rows);
  system.b = read_vector(comm, folder + "/b-" + ranks, rows);
  system.guess = read_vector(comm, folder + "/x-" + ranks, rows);
  std::vector<double> now, made;
  program_matrix(comm, p, made);
  SparseMatrix matrix = program_matrix(comm, a, now);
  system.apply = [&](std::span<const double> x, std::span<double> y) { matrix.multiply(x, y); };
  const std::string kind = how.substr(0, how.find(' '));
  const std::string rest = kind.size() < how.size() ? how.substr(kind.size() + 1) : "";
  const std::string solution = folder + "/solution-" + ranks;
  if (kind == "record") {
    System exact = system;
    const Result result = solve_by_petsc(exact, a, a, {}, rest);
    write_vector(comm, solution, result.x);
    print(system, result, "reference");
    return 0;
  }
  system.solution = read_vector(comm, solution, rows);
  if (kind == "program")
    print(system, solve_by_program(system, matrix, now, made, method_of(rest)), "");
  else
    print(system, solve_by_petsc(system, a, p, {}, rest), "");
  return 0;
}

}  // namespace couplet::benchmark
