// SPDX-License-Identifier: Apache-2.0
// All solution methods give the same answer, and the same on any number of ranks.
#include "solid_solver/body/method_choice.hpp"
#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing::methods_test {
using namespace elastic;
using namespace mesh;

using MethodType = MethodParameters::Type;
using FaceGradient = MethodParameters::FaceGradient;
using Acceleration = MethodParameters::Acceleration;
using Preconditioner = MethodParameters::Preconditioner;
using Choice = MethodParameters::LinearSolver;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A block 2 x 1 x 1 m clamped at xmin, sliding on ymin, sheared on top, its own weight.
SolidParameters sheared_block() {
  SolidParameters p = box_parameters(3);
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0", "1e-6*y"});
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["zmax"] = boundary(Type::traction, {"1e6", "2e5*x", "-3e6"});
  p.gravity = {0, 0, -9.81};
  p.method.relative_tolerance = 1e-10;
  p.method.max_iterations = 5000;
  return p;
}

std::unique_ptr<Solid> solved(SolidParameters p, const MethodParameters& method,
                              BoxCells cells = BoxCells::hexahedra, MPI_Comm comm = MPI_COMM_WORLD) {
  p.method = method;
  RawMesh raw = make_box(cells, {10, 5, 5}, Vec3::Zero(), Vec3(2, 1, 1));
  perturb_interior(raw, 0.15, 3);
  return stepped(raw, p, comm);
}

MethodParameters method(MethodType type, FaceGradient gradient, double tolerance = 1e-10) {
  MethodParameters m;
  m.type = type;
  m.face_gradient = gradient;
  m.relative_tolerance = tolerance;
  m.max_iterations = 5000;
  return m;
}

/// Displacements of all cells by cell_id: two meshes of one block may be cut up differently.
std::vector<double> whole(const Solid& solid) {
  const int dim = solid.body().mesh().dim;
  const Index n = solid.body().mesh().cells.n_owned();
  std::vector<double> values(std::size_t(parallel::sum(MPI_COMM_WORLD, GlobalIndex(n))) * dim, 0);
  for (Index c = 0; c < n; ++c)
    for (int a = 0; a < dim; ++a)
      values[std::size_t(solid.body().mesh().cell_id[c]) * dim + a] =
          solid.stepper().state().cell_u[std::size_t(c) * dim + a];
  MPI_Allreduce(MPI_IN_PLACE, values.data(), int(values.size()), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return values;
}

/// Largest difference of the cells' displacements over their largest size.
double difference(const Solid& one, const Solid& other) {
  return difference_by_cell(displacement_by_cell(one), displacement_by_cell(other));
}

/// All methods of the thesis's gradient.
std::vector<MethodParameters> all_methods() {
  constexpr FaceGradient gradient = FaceGradient::thesis;
  std::vector<MethodParameters> methods;
  for (const Choice c : {Choice::direct, Choice::bicgstab_ilu}) {
    methods.push_back(method(MethodType::block_coupled, gradient));
    methods.back().linear_solver = c;
  }
  for (const Acceleration a : {Acceleration::none, Acceleration::aitken, Acceleration::anderson}) {
    methods.push_back(method(MethodType::segregated, gradient));
    methods.back().acceleration = a;
  }
  return methods;
}

TEST(SolidMethods, all_give_the_same_answer) {
  double worst = 0;
  const auto methods = all_methods();
  const auto first = solved(sheared_block(), methods.front());
  for (std::size_t m = 1; m < methods.size(); ++m) {
    const auto other = solved(sheared_block(), methods[m]);
    const double gap = difference(*first, *other);
    EXPECT_LT(gap, 1e-6) << "method " << m;
    worst = std::max(worst, gap);
  }
  RecordProperty("worst", fmt::format("{:.3e}", worst));
}

TEST(SolidMethods, the_two_face_gradients_differ) {
  const auto thesis = solved(sheared_block(), method(MethodType::block_coupled, FaceGradient::thesis));
  const auto symmetric = solved(sheared_block(), method(MethodType::newton_krylov, FaceGradient::symmetric));
  EXPECT_GT(difference(*thesis, *symmetric), 1e-3);
}

// Numbers that do not depend on the partition: compared with those of one rank, computed beside on
// MPI_COMM_SELF.
TEST(SolidMethods, ranks_do_not_change_the_answer) {
  double worst = 0;
  for (const MethodType type :
       {MethodType::newton_krylov, MethodType::segregated, MethodType::block_coupled}) {
    MethodParameters m = method(
        type, type == MethodType::newton_krylov ? FaceGradient::symmetric : FaceGradient::thesis, 1e-12);
    m.preconditioner = Preconditioner::multigrid;
    const auto together = solved(sheared_block(), m);
    const auto alone = solved(sheared_block(), m, BoxCells::hexahedra, MPI_COMM_SELF);
    const double relative = difference(*alone, *together);
    EXPECT_LT(relative, 1e-8);
    worst = std::max(worst, relative);
  }
  RecordProperty("worst", fmt::format("{:.3e}", worst));
}

/// Iterations of 20 steps of a block that begins to move as a whole and is held on one side.
int iterations_of_motion(MethodParameters::Predictor predictor, int corrections_kept,
                         std::vector<double>& end) {
  SolidParameters p = box_parameters(3);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "1e6*sin(2000*t)", "0"});
  p.method = method(MethodType::newton_krylov, FaceGradient::symmetric, 1e-8);
  p.method.preconditioner = Preconditioner::multigrid;
  p.method.predictor = predictor;
  p.method.corrections_kept = corrections_kept;
  const auto solid = make_solid(make_box(BoxCells::hexahedra, {10, 4, 4}, Vec3::Zero(), Vec3(2, 1, 1)), p);
  int iterations = 0;
  for (int i = 0; i < 20; ++i) {
    step(*solid, 1e-5);
    iterations += solid->stepper().effort().iterations;
  }
  end = whole(*solid);
  return iterations;
}

TEST(SolidMethods, predictors_save_iterations_and_change_nothing) {
  using Predictor = MethodParameters::Predictor;
  std::vector<double> none_end, euler_end, kept_end;
  const int none = iterations_of_motion(Predictor::none, 0, none_end);
  const int euler = iterations_of_motion(Predictor::euler, 0, euler_end);
  const int kept = iterations_of_motion(Predictor::euler, 4, kept_end);
  fmt::print("iterations: no predictor {}, Euler {}, with earlier corrections {}\n", none, euler, kept);
  EXPECT_LT(euler, none);
  EXPECT_LT(kept, 0.75 * euler);
  double size = 0;
  for (const double u : none_end) size = std::max(size, std::abs(u));
  for (std::size_t i = 0; i < none_end.size(); ++i) {
    ASSERT_NEAR(euler_end[i], none_end[i], 1e-5 * size);
    ASSERT_NEAR(kept_end[i], none_end[i], 1e-5 * size);
  }
}

/// Iterations and the sum of the displacements along z of a bar of n cells along and 2 x 2 across, n to 1; by conjugate gradients.
std::pair<int, double> bent_bar(int n, bool on_springs, MPI_Comm comm = MPI_COMM_WORLD) {
  SolidParameters p = box_parameters(3);
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "0", "1e5"});
  if (on_springs) {
    p.boundaries["xmin"] = sprung("1e12");  // [N/m^3], beside E / 1 m = 2e11
  }
  p.method = method(MethodType::newton_krylov, FaceGradient::symmetric, 1e-9);
  p.method.preconditioner = Preconditioner::multigrid;
  Solid solid(distribute(comm, make_box(BoxCells::hexahedra, {n, 2, 2}, Vec3::Zero(), Vec3(n, 1, 1))), p,
              SolidContext{});
  step(solid, 1);
  double sum_z = 0;
  for (Index c = 0; c < solid.body().mesh().cells.n_owned(); ++c)
    sum_z += solid.stepper().state().cell_u[std::size_t(c) * 3 + 2];
  return {solid.stepper().effort().iterations, parallel::sum(comm, sum_z)};
}

// By the rigid motions of aggregates: 100 cubes along took 2108 iterations without them. What springs hold is in their operator.
TEST(SolidMethods, slender_bodies_bend) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) {
    const double bent = bent_bar(40, false).second;
    EXPECT_NEAR(bent_bar(40, false, MPI_COMM_SELF).second, bent, 1e-6 * std::abs(bent));
    const double sprung = bent_bar(65, true).second;
    EXPECT_NEAR(bent_bar(65, true, MPI_COMM_SELF).second, sprung, 1e-6 * std::abs(sprung));
    return;
  }
  const auto [iterations, bent] = bent_bar(100, false);
  const auto [on_springs, same] = bent_bar(100, true);
  RecordProperty("iterations", iterations);
  RecordProperty("on springs", on_springs);
  fmt::print("{} iterations, {} on springs\n", iterations, on_springs);
  EXPECT_LT(iterations, 200);
  EXPECT_LT(on_springs, 200);
  EXPECT_NEAR(same, bent, 3e-2 * std::abs(bent));  // the springs give a little
}

// Five thousand times as long as thick: conjugate gradients with multigrid do not converge, and factors, which the program takes
// then, give F L^3 / (3 E I).
TEST(SolidMethods, a_foil_is_solved_by_factors_where_the_iteration_that_was_chosen_fails) {
  constexpr double thickness = 2e-4;
  SolidParameters p = box_parameters(2);
  p.plane = SolidParameters::Plane::stress;
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "10"});
  const RawMesh foil = make_box(BoxCells::quadrilaterals, {100, 2, 1}, Vec3::Zero(), Vec3(1, thickness, 0));
  const auto solid = stepped(foil, p);
  const double bent = 4 * 10 * thickness / (200e9 * std::pow(thickness, 3));
  EXPECT_NEAR(displacement_at(*solid, Vec3(1, thickness, 0))[1] / bent, 1, 0.15);
  std::vector<double> again(solid->stepper().last_solve().rhs.size(), 0);
  EXPECT_LE(solid->stepper().method()->solve(solid->stepper().last_solve().rhs, again).iterations, 20);
  EXPECT_THAT(solid->stepper().method()->name(), HasSubstr("multigrid"));
  expect_same_after_restart(foil, p, 0.5, 0.5);
  p.method.preconditioner = Preconditioner::multigrid;
  EXPECT_THROW(stepped(foil, p), Error);
}

TEST(SolidMethods, a_segregated_run_that_is_cut_short_says_so) {
  MethodParameters m = method(MethodType::segregated, FaceGradient::thesis);
  m.max_iterations = 3;
  EXPECT_NE(support::error_of<SolveFailure>([&] { solved(sheared_block(), m); }).find("3 outer iterations"),
            std::string::npos);
}

/// A block in the plane, pulled: one step with what a method has been told.
void pulled(const MethodParameters& m) {
  SolidParameters p = box_parameters(2);
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "1e6"});
  p.method = m;
  const auto solid = stepped(make_box(BoxCells::quadrilaterals, {40, 4, 1}, Vec3::Zero(), Vec3(10, 1, 0)), p);
}

struct Failing {
  const char* advice;
  MethodParameters running, advised;
};

/// Each method with three iterations, and what it names as another way.
std::vector<Failing> failing_methods() {
  std::vector<Failing> all{
      {"{type: newton-krylov, face-gradient: symmetric}",
       method(MethodType::segregated, FaceGradient::thesis),
       {}},
      {"{linear-solver: direct}", method(MethodType::block_coupled, FaceGradient::thesis), {}},
      {"{preconditioner: factors}", method(MethodType::newton_krylov, FaceGradient::symmetric), {}},
      {"{preconditioner: factors}", method(MethodType::newton_krylov, FaceGradient::symmetric), {}}};
  all[1].running.linear_solver = Choice::bicgstab_ilu;
  all[2].running.preconditioner = Preconditioner::multigrid;
  all[3].running.preconditioner = Preconditioner::mixed;
  all[3].running.volume_strain = MethodParameters::VolumeStrain::cells;
  for (Failing& f : all) {
    f.running.max_iterations = 3;
    f.advised = f.running;
  }
  all[0].advised.type = MethodType::newton_krylov;
  all[0].advised.face_gradient = FaceGradient::symmetric;
  all[1].advised.linear_solver = Choice::direct;
  all[2].advised.preconditioner = all[3].advised.preconditioner = Preconditioner::factors;
  return all;
}

// Advice that names what has just failed helps nobody: what is named is another method, and with nothing else changed it solves.
TEST(SolidMethods, the_advice_of_a_failed_solve_is_another_method_and_that_one_solves) {
  for (const Failing& f : failing_methods()) {
    EXPECT_THAT([&] { pulled(f.running); }, ::testing::ThrowsMessage<Error>(HasSubstr(f.advice)));
    EXPECT_NO_THROW(pulled(f.advised)) << f.advice;
  }
}

/// What `auto` takes for the symmetric gradient of a bar ten times as long as thick, for so many solves.
std::string chosen_for(BoxCells cells, int across, double solves) {
  const int dim = dimension_of(cells);
  const auto [mesh, geometry] =
      distribute(MPI_COMM_WORLD,
                 make_box(cells, {10 * across, across, across}, Vec3::Zero(), Vec3(10, 1, dim == 3 ? 1 : 0)));
  const std::vector<BoundaryRow> held(mesh.patches.size(), fixed_row());
  const ElasticOperator elastic(mesh, geometry, held, LameConstants{4e6, 6e6});
  const ElasticKernel kernel(mesh, elastic, FaceGradientScheme::symmetric);
  std::vector<double> inertia;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) inertia.push_back(1e3 * geometry.volume[c]);
  MethodParameters parameters;
  parameters.solves = solves;
  kernel.set_density(inertia);
  return make_solution_method({mesh, elastic, inertia, kernel, 1}, parameters)->name();
}

TEST(SolidMethods, auto_makes_factors_where_the_run_makes_so_many_solves_that_they_pay) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::tetrahedra}) {
    EXPECT_THAT(chosen_for(cells, cells == BoxCells::quadrilaterals ? 12 : 3, 1000), HasSubstr("factors"))
        << name(cells);
    EXPECT_THAT(chosen_for(cells, cells == BoxCells::quadrilaterals ? 12 : 3, 10), HasSubstr("multigrid"))
        << name(cells);
  }
  EXPECT_THAT(chosen_for(BoxCells::hexahedra, 5, 1e6), HasSubstr("multigrid"))
      << "a cycle is cheaper than a solve by factors";
}

TEST(SolidMethods, a_solve_that_does_not_converge_names_method_iterations_residual_and_what_to_try) {
  SolidParameters p = box_parameters(2);
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "1e6"});
  p.method.type = MethodParameters::Type::block_coupled;
  p.method.face_gradient = FaceGradient::thesis;
  p.method.linear_solver = MethodParameters::LinearSolver::bicgstab_ilu;
  p.method.max_iterations = 1;
  const auto solid =
      make_solid(make_box(BoxCells::quadrilaterals, {40, 4, 1}, Vec3::Zero(), Vec3(10, 1, 0)), p);
  EXPECT_THAT([&] { step(*solid, 1); },
              ::testing::ThrowsMessage<Error>(AllOf(
                  HasSubstr("did not converge"), HasSubstr("in 1 of at most 1 iterations"),
                  HasSubstr("The method is block-coupled (BiCGStab, ILU), least-squares face gradient."),
                  HasSubstr("linear-solver: direct"))));
}

}  // namespace couplet::testing::methods_test
