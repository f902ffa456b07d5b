// SPDX-License-Identifier: Apache-2.0
// Linear buckling against closed forms, free vibrations of loaded bodies, the cheap estimate, and equilibria that do not hold.
#include "solid_solver/diagnostics/buckling.hpp"
#include "common/diagnostics/finding.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::buckling_test {
using namespace mesh;

constexpr double pi = std::numbers::pi, modulus = 210e9;

/// Clamped at x = 0, `slender` times as long as thick, 1 m long; compressed by `stress` (plane stress or 3-D).
SolidParameters column(int dim, double stress) {
  SolidParameters p = box_parameters(dim);
  p.plane = dim == 2 ? SolidParameters::Plane::stress : SolidParameters::Plane::strain;
  p.method.face_gradient = FaceGradient::symmetric;
  p.material = {7800, modulus, 0.3};
  p.boundaries["xmin"] = clamped(dim);
  std::vector<std::string> load(std::size_t(dim), "0");
  load[0] = fmt::format("{}*t", -stress);
  p.boundaries["xmax"] = boundary(Type::traction, load);
  return p;
}

RawMesh bar(BoxCells cells, int along, int across, double thickness) {
  const int dim = dimension_of(cells);
  return make_box(cells, {along, across, dim == 3 ? across : 1}, Vec3::Zero(),
                  Vec3(1, thickness, dim == 3 ? thickness : 0));
}

double euler(double thickness) { return pi * pi / 48 * thickness * thickness * modulus; }

std::vector<double> factors(const Solid& solid, int n, double time = 1) {
  return find_buckling(solid.body(), prestress_of(solid.body(), solid.fields(), time), n).factor;
}

/// Of the findings from number `from` on; -1: none has this id.
int severity_of(const char* id, std::size_t from) {
  int worst = -1;
  for (std::size_t i = from; i < diagnostics::findings().size(); ++i)
    if (diagnostics::findings()[i].id == id)
      worst = std::max(worst, int(diagnostics::findings()[i].severity));
  return worst;
}

const diagnostics::Finding& last_of(const char* id) {
  return *std::ranges::find(diagnostics::findings().rbegin(), diagnostics::findings().rend(), id,
                            &diagnostics::Finding::id);
}

class Column : public ::testing::TestWithParam<BoxCells> {};

TEST_P(Column, buckles_at_eulers_loads) {
  const int dim = dimension_of(GetParam());
  const auto solid = stepped(bar(GetParam(), dim == 2 ? 100 : 40, dim == 2 ? 8 : 2, dim == 2 ? 0.02 : 0.05),
                             column(dim, 1e5));
  const double right = euler(dim == 2 ? 0.02 : 0.05) / 1e5;
  const std::vector<double> found = factors(*solid, dim == 2 ? 2 : 1);
  ASSERT_FALSE(found.empty());
  RecordProperty("gap", fmt::format("{:.4f}", found[0] / right - 1));
  EXPECT_NEAR(found[0], right, (dim == 2 ? 0.01 : 0.03) * right);
  if (dim == 2) {
    EXPECT_NEAR(found[1], 9 * right, 0.02 * 9 * right);
  }
}

INSTANTIATE_TEST_SUITE_P(Solid, Column,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::hexahedra,
                                           BoxCells::tetrahedra),
                         [](const auto& test) { return name(test.param); });

TEST(ColumnInTension, buckles_at_no_load) {
  const auto solid = stepped(bar(BoxCells::quadrilaterals, 40, 4, 0.05), column(2, -1e5));
  EXPECT_TRUE(factors(*solid, 2).empty());
}

TEST(UnloadedColumn, is_refused) {
  const auto solid = stepped(bar(BoxCells::quadrilaterals, 10, 2, 0.05), column(2, 0));
  EXPECT_THROW(factors(*solid, 2), SolveFailure);
}

/// omega^2 of a clamped-free beam under a dead axial load, from EI w'''' + P w'' = m omega^2 w:
/// 0.5196 and 1.4497 of that without at half of Euler's load and at as much tension.
TEST(LoadedColumn, swings_more_slowly_and_in_tension_faster) {
  const double critical = euler(0.05);
  const auto first = [&](double part) {
    const auto solid = stepped(bar(BoxCells::quadrilaterals, 40, 8, 0.05), column(2, part * critical));
    return preloaded_modes(solid->body(), prestress_of(solid->body(), solid->fields(), 1), 1).eigenvalue[0];
  };
  const double without = first(0);
  EXPECT_NEAR(first(0.5) / without, 0.5196, 0.006);
  EXPECT_NEAR(first(-0.5) / without, 1.4497, 0.006);
  EXPECT_THROW(first(1.2), SolveFailure);
}

std::vector<double> squared_frequencies(const RawMesh& raw, const SolidParameters& p, int n) {
  const auto solid = stepped(raw, p);
  return preloaded_modes(solid->body(), prestress_of(solid->body(), solid->fields(), 1), n).eigenvalue;
}

/// A square beam turns about the z axis: the load of the displaced beam lowers omega^2 in the plane of rotation by that of
/// the rotation, and leaves it across the plane.
TEST(RotatingBeam, swings_more_slowly_in_the_plane_of_rotation) {
  SolidParameters p = column(3, 0);
  constexpr double rotation = 50;
  p.body_force = {{fmt::format("7800*{}*(x + 0.3)", rotation * rotation)},
                  {fmt::format("7800*{}*(y - 0.025)", rotation * rotation)},
                  {"0"}};
  const std::vector<double> found = squared_frequencies(bar(BoxCells::hexahedra, 20, 2, 0.05), p, 2);
  EXPECT_NEAR((found[1] - found[0]) / (rotation * rotation), 1, 0.01);
}

/// A cube of 1 m on springs in a liquid that reaches to its middle: the water plane adds rho g A to the stiffness of the
/// motion up and down. Without potential a body force belongs to the body and adds nothing.
TEST(FloatingCube, is_held_by_its_water_plane) {
  SolidParameters p = box_parameters(3);
  p.material = {1000, modulus, 0.3};
  p.boundaries["zmin"] = p.boundaries["zmax"] = sprung("1e5");
  for (const char* wet : {"xmin", "xmax", "ymin", "ymax"}) {
    p.boundaries[wet] = boundary(Type::hydrostatic_pressure);
    p.boundaries[wet].load.density = 5000;
    p.boundaries[wet].load.gravity = {0, -10, 0};
    p.boundaries[wet].load.level = {"0.5"};
  }
  const RawMesh cube = make_box(BoxCells::hexahedra, {3, 3, 3}, Vec3::Zero(), Vec3(1, 1, 1));
  // Among the six rigid motions.
  const auto near = [](double value) { return ::testing::Contains(::testing::DoubleNear(value, 0.1)); };
  EXPECT_THAT(squared_frequencies(cube, p, 6), ::testing::AllOf(near(200), near(250)));
  p.body_force = {{"0"}, {"1000*100*x"}, {"0"}};
  EXPECT_THAT(squared_frequencies(cube, p, 6), ::testing::AllOf(near(200), near(250)));
  p.body_force = {{"1000*100*x"}, {"0"}, {"0"}};
  EXPECT_THAT(squared_frequencies(cube, p, 6), ::testing::AllOf(near(100), near(250)));
}

/// Ring of mean radius 1 m, t thick, in plane strain; a quarter of it. [timoshenko1961]: 3 E I / ((1 - nu^2) R^3) under a pressure
/// that follows, 4 E I / ((1 - nu^2) R^3) under a radial load that keeps its direction.
double ring(bool follows) {
  constexpr double t = 0.01;
  RawMesh raw = make_box(BoxCells::quadrilaterals, {8, 120, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  for (Vec3& x : raw.points) {
    const double r = 1 + t * (x[0] - 0.5), angle = 0.5 * pi * x[1];
    x = Vec3(r * std::cos(angle), r * std::sin(angle), 0);
  }
  SolidParameters p = box_parameters(2);
  p.material = {7800, modulus, 0.3};
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
  if (follows) {
    p.boundaries["xmax"] = pressed("1e3");
  } else {
    p.boundaries["xmax"] = boundary(Type::traction, {"-1e3*x/sqrt(x*x+y*y)", "-1e3*y/sqrt(x*x+y*y)"});
  }
  const auto solid = stepped(raw, p);
  const std::vector<double> found = factors(*solid, 1);
  const double bending = modulus / (1 - 0.09) * t * t * t / 12;
  return found.empty() ? 0 : found[0] * 1e3 * (1 + t / 2) / bending;
}

TEST(Ring, buckles_at_three_under_pressure_and_at_four_under_a_dead_load) {
  EXPECT_NEAR(ring(true), 3, 0.04);
  EXPECT_NEAR(ring(false), 4, 0.05);
}

TEST(BucklingEstimate, finds_low_factors_and_leaves_others_alone) {
  const double critical = euler(0.05);
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::tetrahedra})
    for (const double part : {0.1, 0.2, 0.5, 1.3, -1.0}) {
      SCOPED_TRACE(fmt::format("{} {}", name(cells), part));
      const auto solid = stepped(bar(cells, 40, dimension_of(cells) == 2 ? 4 : 2, 0.05),
                                 column(dimension_of(cells), part * critical));
      double seen = 0;
      const BucklingEstimate found = estimate_buckling(solid->body(), solid->fields(), solid->stepper(),
                                                       *solid->stepper().method(), seen, true);
      RecordProperty(fmt::format("factor_{}", part), fmt::format("{:.4f}", found.factor));
      if (part == 0.1 || part < 0)
        EXPECT_EQ(found.factor, 0);
      else
        EXPECT_NEAR(found.factor, 1 / part, 0.15 / part);  // a bound from above, on a mesh that is too stiff
    }
}

TEST(BucklingFinding, is_told_of_linear_runs_near_and_above_the_load) {
  const double critical = euler(0.05);
  const auto run = [&](double part, bool seeks_buckling) {
    const support::SharedFolder folder;
    SolidParameters p = column(2, part * critical);
    p.seeks_buckling = seeks_buckling;
    p.output.buckling = seeks_buckling ? 2 : 0;
    const LoadedMesh body = distribute(MPI_COMM_WORLD, bar(BoxCells::quadrilaterals, 40, 4, 0.05));
    Solid solid(body, p, SolidContext{"solid", folder.path()});
    support::observe(solid, 1, 1);
    MPI_Barrier(MPI_COMM_WORLD);
  };
  for (const auto& [part, severity] :
       {std::pair(0.1, -1), {0.5, int(base::Severity::warning)}, {1.2, int(base::Severity::wrong)}}) {
    const std::size_t before = diagnostics::findings().size();
    run(part, true);
    EXPECT_EQ(severity_of("buckling", before), -1) << "the factor is the answer of a buckling analysis";
    run(part, false);
    EXPECT_EQ(severity_of("buckling", before), severity) << part;
  }
}

TEST(BucklingFinding, above_a_factor_of_three_is_told_of_what_bends_and_not_of_what_is_pushed_alone) {
  // Under a load across of any size the deflection grows by 1/(f - 1): of f = 4 a third, of f = 8 a seventh.
  const double critical = euler(0.05);
  const auto told = [&](double part, const char* lateral) {
    const std::size_t before = diagnostics::findings().size();
    SolidParameters p = column(2, part * critical);
    p.boundaries["xmax"].value[1] = {lateral};
    const auto solid = make_solid(bar(BoxCells::quadrilaterals, 40, 4, 0.05), p);
    support::observe(*solid, 1, 1);
    return severity_of("buckling", before);
  };
  EXPECT_EQ(told(0.25, "1e6"), int(base::Severity::warning));
  const diagnostics::Finding& last = last_of("buckling");
  EXPECT_NE(last.sentence.find("by a fraction of 0.3"), std::string::npos) << last.sentence;
  EXPECT_EQ(told(0.25, "0"), -1);
  EXPECT_EQ(told(0.125, "1e6"), -1);
}

/// A column of rubber under a growing load, t from 0 to 1 s in five steps: `part` of Euler's load at the end.
void compress(double part, double lateral, BoxCells cells) {
  const int dim = dimension_of(cells);
  SolidParameters p = column(dim, part * pi * pi / 48 * 0.01 * 1e7);
  p.plane = SolidParameters::Plane::strain;
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1100, 1e7, 0};
  p.material.law = "neo-hookean";
  p.boundaries["xmax"].value[1] = {fmt::format("{}*t", lateral)};
  const auto solid = make_solid(bar(cells, dim == 2 ? 40 : 20, dim == 2 ? 4 : 2, 0.1), p);
  support::observe(*solid, 5, 0.2);
}

TEST(Equilibrium, that_does_not_hold_is_told_with_the_load_where_it_was_lost) {
  const std::size_t before = diagnostics::findings().size();
  compress(0.85, 0, BoxCells::quadrilaterals);
  compress(0.85, 0, BoxCells::tetrahedra);
  compress(-3, 0, BoxCells::quadrilaterals);
  compress(0.85, 100, BoxCells::quadrilaterals);
  EXPECT_EQ(severity_of("unstable-equilibrium", before), -1);
  compress(2.6, 0, BoxCells::quadrilaterals);
  ASSERT_EQ(severity_of("unstable-equilibrium", before), int(base::Severity::wrong));
  const diagnostics::Finding& last = last_of("unstable-equilibrium");
  EXPECT_LT(last.number, 0);
  EXPECT_NE(last.sentence.find("lost near t = 0.3"), std::string::npos) << last.sentence;  // 1 / 2.6
}

/// The least stiffness of a straight column of rubber 50 times as long as thick under `part` of Euler's load, in one step.
double stiffness_under(double part) {
  SolidParameters p = column(2, part * pi * pi / 48 * 0.02 * 0.02 * 1e7);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.plane = SolidParameters::Plane::strain;
  p.material = {1100, 1e7, 0};
  p.material.law = "neo-hookean";
  const auto solid = make_solid(bar(BoxCells::quadrilaterals, 40, 2, 0.02), p);
  support::observe(*solid, 1, 1);
  const SolidBody& body = solid->body();
  const SolidState& now = solid->stepper().state();
  return body.lowest_stiffness(body.unknowns_of(now.cell_u, now.face_u), now.known);
}

TEST(Equilibrium, of_a_slender_column_is_told_apart_within_a_ten_thousandth_of_its_load) {
  double low = 0.95, high = 1, at_low = stiffness_under(low), at_high = stiffness_under(high);
  for (int i = 0; i < 3; ++i) {
    const double next = low - at_low * (high - low) / (at_high - at_low);
    low = high, at_low = at_high;
    high = next, at_high = stiffness_under(high);
  }
  const double critical = low - at_low * (high - low) / (at_high - at_low);
  const std::size_t before = diagnostics::findings().size();
  EXPECT_GT(stiffness_under(critical * (1 - 5e-5)), 0);
  EXPECT_EQ(severity_of("unstable-equilibrium", before), -1);
  const double beyond = stiffness_under(critical * (1 + 5e-5));
  EXPECT_LT(beyond, 0);
  EXPECT_GT(beyond, -1e-4);
  EXPECT_EQ(severity_of("unstable-equilibrium", before), int(base::Severity::wrong));
}

}  // namespace couplet::testing::buckling_test
