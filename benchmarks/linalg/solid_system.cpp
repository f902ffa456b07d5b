// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>

#include "benchmarks/linalg/meter.hpp"
#include "benchmarks/linalg/petsc_cycle.hpp"
#include "benchmarks/linalg/system.hpp"
#include "common/app/program.hpp"
#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/linalg/petsc.hpp"
#include "common/mesh/load.hpp"
#include "solid_solver/body/method_choice.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"
#include "solid_solver/method/mixed_form.hpp"
#include "solid_solver/solid.hpp"

namespace couplet::benchmark {

using namespace linalg;
using namespace solid;
namespace {

// Forces from volume residuals relative to b, as in the mixed form.
constexpr double forces_left = 1e-6;

struct Files {
  std::string folder, ranks;
  std::string of(const char* name) const { return folder + "/" + name + "-" + ranks; }
};

SolidProblem problem_of(const SolidBody& body) { return {body.mesh(), body.elastic(), {}, body.kernel(), 0}; }

/// Records the step as Couplet solves it: its load and result.
void record(Solid& solid, const Files& files) {
  solid.initialise();
  solid.begin_step({0, 1, coupling::Scheme::standalone, 0});
  solid.solve({});
  const LastSolve& last = solid.stepper().last_solve();
  const MPI_Comm comm = solid.body().mesh().comm;
  write_vector(comm, files.of("b"), last.rhs);
  write_vector(comm, files.of("solution"), last.unknowns);
  if (parallel::comm_rank(comm) == 0)
    std::printf("RESULT {\"note\": \"%s\"}\n", solid.stepper().method()->name().c_str());
}

/// Rigid motions for aggregation, which renumbers nodes and uses their positions.
void add_rigid_motions(const SolidBody& body, Mat p) {
  const mesh::Mesh& mesh = body.mesh();
  std::vector<double> places;
  const auto add = [&](const Vec3& x) {
    for (int a = 0; a < mesh.dim; ++a) places.push_back(x[a]);
  };
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) add(body.geometry().cell_centre[c]);
  for (const Index f : body.elastic().unknown_faces()) add(body.geometry().face_centre[f]);
  ::Vec v = vector_of(mesh.comm, places);
  petsc_check(VecSetBlockSize(v, mesh.dim));
  MatNullSpace motions = nullptr;
  petsc_check(MatNullSpaceCreateRigidBody(v, &motions));
  petsc_check(MatSetNearNullSpace(p, motions));
  petsc_check(MatNullSpaceDestroy(&motions));
  petsc_check(VecDestroy(&v));
}

/// Assembled operator. It equals the kernel's unless faces share at edges; then it only preconditions PETSc.
Result by_assembled(const System& system, const SolidBody& body, const std::string& options,
                    std::string& note) {
  const Meter assembling(system.comm);
  const SparseMatrix matrix = elastic::symmetric_matrix(body.mesh(), body.elastic(), {});
  Mat p = matrix.petsc();
  char text[200];
  std::vector<double> of_kernel(system.b.size()), of_matrix(system.b.size());
  system.apply(system.solution, of_kernel);
  matrix.multiply(system.solution, of_matrix);
  double squares[2] = {0, 0};
  for (std::size_t i = 0; i < of_kernel.size(); ++i) {
    squares[0] += (of_kernel[i] - of_matrix[i]) * (of_kernel[i] - of_matrix[i]);
    squares[1] += of_kernel[i] * of_kernel[i];
  }
  const double difference =
      std::sqrt(parallel::sum(system.comm, squares[0]) / parallel::sum(system.comm, squares[1]));
  const bool is_same = difference < 1e-7;
  // Entries of 8 bytes with columns of 4; unknown for a matrix made of triplets.
  MatInfo info;
  petsc_check(MatGetInfo(p, MAT_GLOBAL_SUM, &info));
  std::snprintf(text, sizeof text, "assembled in %.3g s, %.3g entries, %.0f MB%s", assembling.seconds(),
                info.nz_used, 12 * info.nz_used / 1048576, is_same ? "" : ", not quite the operator");
  note = text;
  petsc_check(MatSetBlockSize(p, body.mesh().dim));
  petsc_check(MatSetOption(p, MAT_SYMMETRIC, PETSC_TRUE));
  petsc_check(MatSetOption(p, MAT_SPD, PETSC_TRUE));
  add_rigid_motions(body, p);
  Result result = solve_by_petsc(system, is_same ? p : nullptr, p, {}, options);
  result.megabytes += 12 * info.nz_used / 1048576;
  return result;
}

Result by_program(const System& system, const SolidBody& body) {
  Result result;
  const Meter whole(system.comm);
  const auto method = make_solution_method(problem_of(body), body.parameters().method);
  result.setup = whole.seconds();
  result.x = system.guess;
  result.iterations = method->solve(system.b, result.x).iterations;
  result.solve = whole.seconds() - result.setup;
  result.megabytes = whole.peak();
  return result;
}

/// Couplet's operator and preconditioner with PETSc's iteration.
Result by_krylov(const System& system, const SolidBody& body, const std::string& options) {
  const Meter whole(system.comm);
  const auto method = make_solution_method(problem_of(body), body.parameters().method);
  const double making = whole.seconds(), peak = whole.peak();
  auto* mixed = dynamic_cast<MixedForm*>(method.get());
  System same = system;
  const double size = norm(system.comm, system.b);
  same.wanted = body.parameters().method.relative_tolerance * size;
  if (mixed) {
    same.b.resize(mixed->n_unknowns());
    same.guess.resize(mixed->n_unknowns());
    same.apply = [&](std::span<const double> x, std::span<double> y) { mixed->apply(x, y); };
  }
  const LinearMap inverse = [&](std::span<const double> r, std::span<double> z) {
    if (mixed) return mixed->precondition(r, z);
    method->approximate_inverse(r, z);
  };
  Result result = solve_by_petsc(same, nullptr, nullptr, inverse, options);
  result.setup += making;
  result.megabytes = std::max(peak, whole.peak());  // the peak of the solve was reset
  result.x.resize(system.b.size());
  return result;
}

/// Like ConjugateGradients, with PETSc's preconditioner instead of the multigrid cycle.
Result by_cycle(const System& system, const SolidBody& body, const std::string& options) {
  Result result;
  const SolidProblem problem = problem_of(body);
  const Meter whole(system.comm);
  int aggregates = 0;
  {
    const std::string name = make_solution_method(problem, body.parameters().method)->name();
    const auto at = name.find("rigid-body modes of ");
    if (at != std::string::npos) aggregates = std::atoi(name.c_str() + at + 20);
  }
  const double choosing = whole.seconds();
  petsc_check(PetscOptionsInsertString(nullptr, options.c_str()));
  elastic::ElasticPreconditioner::Options of;
  of.cycle = petsc_cycle;
  elastic::ElasticPreconditioner preconditioner(problem.mesh, problem.elastic, of);
  std::optional<elastic::CurrentRigidModes> modes;
  if (aggregates > 0) {
    modes.emplace(problem.mesh, problem.elastic, aggregates, std::vector<double>{});
    modes->update(at_rest(problem.mesh));
  }
  KrylovSolver krylov("displacement", system.comm, system.b.size(), system.apply,
                      [&](std::span<const double> r, std::span<double> z) {
                        preconditioner.apply(r, z);
                        if (modes) modes->add_correction(r, z);
                      });
  result.setup = whole.seconds() - choosing;
  result.x = system.guess;
  const MethodParameters& p = body.parameters().method;
  result.iterations =
      krylov.solve(system.b, result.x, {p.relative_tolerance, p.max_iterations, true}).iterations;
  result.solve = whole.seconds() - result.setup - choosing;
  result.megabytes = whole.peak();
  return result;
}

void measure(const SolidBody& body, const Files& files, const std::string& how) {
  const mesh::Mesh& mesh = body.mesh();
  const auto rows = static_cast<PetscInt>(body.elastic().n_unknowns());
  const SolidProblem problem = problem_of(body);
  System system{mesh.comm,
                [&](std::span<const double> x, std::span<double> y) { problem.apply(x, y); },
                read_vector(mesh.comm, files.of("b"), rows),
                std::vector<double>(std::size_t(rows), 0),
                0,
                read_vector(mesh.comm, files.of("solution"), rows)};
  const bool mixed = dynamic_cast<MixedForm*>(make_solution_method(problem, body.parameters().method).get());
  const double tolerance = body.parameters().method.relative_tolerance;
  system.wanted = (mixed ? std::max(forces_left, tolerance) : tolerance) * norm(mesh.comm, system.b);
  const std::string kind = how.substr(0, how.find(' '));
  const std::string rest = kind.size() < how.size() ? how.substr(kind.size() + 1) : "";
  std::string note;
  if (kind == "program") {
    print(system, by_program(system, body), note);
  } else if (kind == "krylov") {
    print(system, by_krylov(system, body, rest), note);
  } else if (kind == "cycle") {
    print(system, by_cycle(system, body, rest), note);
  } else if (kind == "petsc") {
    const Result result = by_assembled(system, body, rest, note);
    print(system, result, note);
  } else {
    throw Error("No kind of solver '{}': record, program, petsc, krylov, cycle.", kind);
  }
}

}  // namespace

int run_solid(const std::string& folder, const std::string& how, int argc, char** argv) {
  SolidParameters parameters;
  app::Program program{.name = "solid_solver", .description = "benchmarks/linalg", .declare = {}, .make = {}};
  program.declare = [&](config::Section& section) { declare(section, parameters); };
  program.environment = petsc_environment;
  program.make = [&](const app::ParticipantContext& context) -> std::unique_ptr<coupling::Participant> {
    mesh::LoadedMesh loaded = mesh::load_mesh(context.comm, context.case_folder / parameters.mesh,
                                              parameters.dimension, parameters.mesh_parameters, {},
                                              zones_of(parameters.materials), true, parameters.mesh_scale);
    const Files files{folder, std::to_string(parallel::comm_size(context.comm))};
    if (how == "record") {
      Solid solid(std::move(loaded), parameters, {context.name, context.output_folder, context.restart_time});
      record(solid, files);
    } else {
      const SolidBody body(std::move(loaded), parameters);
      measure(body, files, how);
    }
    std::fflush(stdout);
    MPI_Barrier(context.comm);
    MPI_Finalize();
    std::_Exit(0);  // there is no run to go on with
  };
  return app::run_program(argc, argv, program);
}

}  // namespace couplet::benchmark
