// SPDX-License-Identifier: Apache-2.0
#include "tests/support/csv.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::output_test {
using namespace mesh;

/// A sheet pulled by 100 MPa * t in plane stress between symmetry planes: u = (s x, -0.3 s y), s = sigma / E.
SolidParameters pulled_sheet() {
  SolidParameters p = box_parameters(2);
  p.plane = SolidParameters::Plane::stress;
  p.boundaries["xmin"] = boundary(Type::symmetry);
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {"1e8*t", "0"});
  p.probes["corner"].point = Vec3(2, 1, 0);
  p.probes["inside"].point = Vec3(0.731, 0.377, 0);
  return p;
}

TEST(SolidOutput, probes_and_reactions_hold_the_displacement_and_the_balance_of_each_step) {
  const support::SharedFolder folder;
  RawMesh raw = make_box(BoxCells::triangles, {6, 4, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  perturb_interior(raw, 0.2, 2);
  Solid solid(distribute(MPI_COMM_WORLD, raw), pulled_sheet(), SolidContext{"solid", folder.path()});
  for (int i = 0; i < 3; ++i) {
    step(solid, 1);
    solid.write_monitors(solid.stepper().state().time);
    solid.write_output(solid.stepper().state().time, i);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (parallel::comm_rank(MPI_COMM_WORLD) != 0) return;
  const support::Csv probes(folder.path() / "probes.csv");
  ASSERT_EQ(probes.rows.size(), 3u);
  EXPECT_EQ(probes.header, "time [s],corner x [m],corner y [m],inside x [m],inside y [m]");
  const double s = 3e8 / 200e9;
  const std::vector<double> expected{3, 2 * s, -0.3 * s, 0.731 * s, -0.3 * 0.377 * s};
  const std::vector<double> last = probes.rows[2];
  ASSERT_EQ(last.size(), expected.size());
  for (std::size_t i = 0; i < last.size(); ++i) EXPECT_NEAR(last[i], expected[i], 1e-12);

  const support::Csv reactions(folder.path() / "reactions.csv");
  ASSERT_EQ(reactions.rows.size(), 3u);
  EXPECT_EQ(reactions.header, "time [s],xmin x [N],xmin y [N],ymin x [N],ymin y [N],load x [N],load y [N]");
  const std::vector<double> forces = reactions.rows[2];
  EXPECT_NEAR(forces[1], -3e8, 1);
  EXPECT_NEAR(forces[5], 3e8, 1);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "solid.xdmf"));

  const support::Csv solver(folder.path() / "solver.csv");
  ASSERT_EQ(solver.rows.size(), 3u);
  EXPECT_EQ(solver.header, "time [s],solves,iterations,inner iterations,residual");
  EXPECT_EQ(solver.rows[2][1], 1);
}

TEST(SolidOutput, probes_watch_velocity_stress_strain_and_what_follows_from_them) {
  const support::SharedFolder folder;
  SolidParameters p = pulled_sheet();
  for (auto& [name, probe] : p.probes)
    probe.fields = {"velocity", "stress", "strain", "equivalent-stress", "principal-stress"};
  RawMesh raw = make_box(BoxCells::triangles, {6, 4, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  perturb_interior(raw, 0.2, 2);
  Solid solid(distribute(MPI_COMM_WORLD, raw), p, SolidContext{"solid", folder.path()});
  for (int i = 0; i < 2; ++i) {
    step(solid, 1);
    solid.write_monitors(solid.stepper().state().time);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (parallel::comm_rank(MPI_COMM_WORLD) != 0) return;
  const auto probes = support::Csv(folder.path() / "probes.csv").columns();
  for (const std::string probe : {"corner", "inside"}) {
    const double x = probe == "corner" ? 2 : 0.731;
    EXPECT_NEAR(probes.at(probe + " velocity x [m/s]").back(), x * 1e8 / 200e9, 1e-12);
    EXPECT_NEAR(probes.at(probe + " stress-xx [Pa]").back(), 2e8, 1);
    EXPECT_NEAR(probes.at(probe + " stress-yy [Pa]").back(), 0, 1);
    EXPECT_NEAR(probes.at(probe + " stress-zz [Pa]").back(), 0, 1e-6);
    EXPECT_NEAR(probes.at(probe + " stress-xy [Pa]").back(), 0, 1);
    EXPECT_NEAR(probes.at(probe + " strain-xx [-]").back(), 1e-3, 1e-11);
    EXPECT_NEAR(probes.at(probe + " strain-yy [-]").back(), -3e-4, 1e-11);
    EXPECT_NEAR(probes.at(probe + " equivalent-stress [Pa]").back(), 2e8, 1);
    EXPECT_NEAR(probes.at(probe + " principal-stress-1 [Pa]").back(), 2e8, 1);
    EXPECT_NEAR(probes.at(probe + " principal-stress-3 [Pa]").back(), 0, 1);
  }
}

TEST(SolidOutput, acceleration_of_a_driven_block_is_that_of_its_support) {
  const support::SharedFolder folder;
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  // So stiff and small that it moves as a whole.
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "1e-3*sin(50*t)"});
  p.initial_velocity = {{"0"}, {"5e-2"}};
  p.damping = SolidDamping{0, 1e-4};
  p.probes["inside"] = {Vec3(0.03, 0.05, 0), {"acceleration"}};
  p.probes["support"] = {Vec3(0, 0.05, 0), {"acceleration"}};
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {3, 3, 1}, Vec3::Zero(), Vec3(0.1, 0.1, 0));
  Solid solid(distribute(MPI_COMM_WORLD, raw), p, SolidContext{"solid", folder.path()});
  for (int i = 0; i < 100; ++i) {
    step(solid, 2e-4);
    solid.write_monitors(solid.stepper().state().time);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (parallel::comm_rank(MPI_COMM_WORLD) != 0) return;
  const double expected = -1e-3 * 2500 * std::sin(50 * solid.stepper().state().time);
  const auto probes = support::Csv(folder.path() / "probes.csv").columns();
  EXPECT_NEAR(probes.at("support acceleration y [m/s^2]").back() / expected, 1, 1e-4);
  EXPECT_NEAR(probes.at("inside acceleration y [m/s^2]").back() / expected, 1, 0.01);
}

// The stress at a point comes from cells and boundary faces; at a symmetry plane from their mirror images
// too.
TEST(SolidOutput, point_tensors_are_exact_for_linear_fields_up_to_the_boundary) {
  RawMesh raw = make_box(BoxCells::hexahedra, {5, 4, 3}, Vec3::Zero(), Vec3(2, 1, 1));
  perturb_interior(raw, 0.2, 3);
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  const std::size_t plane = std::size_t(mesh.find_patch("zmin") - mesh.patches.data());
  std::vector<bool> is_symmetry(mesh.patches.size(), false);
  is_symmetry[plane] = true;
  // Even components do not depend on z, odd ones (shear across the plane) grow with z: smooth over the
  // mirror.
  const auto field = [](const Vec3& x) {
    Tensor3 t;
    const double shear = 3 * x[2], other = -2 * x[2];
    t << 1 + x[0] - x[1], 2 * x[1], shear, 2 * x[1], x[0], other, shear, other, 4 - x[1];
    return t;
  };
  std::vector<Tensor3> cells, faces;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) cells.push_back(field(geometry.cell_centre[c]));
  for (Index b = 0; b < mesh.boundary.n_owned(); ++b)
    faces.push_back(field(geometry.face_centre[mesh.n_interior + b]));
  const fv::VertexInterpolation inside(mesh, geometry,
                                       std::vector(mesh.patches.size(), fv::PatchStencil::fixed));
  const std::vector<double> at_points =
      PointTensors(mesh, geometry, is_symmetry, inside).interpolate(cells, faces).front();
  for (Index v = 0; v < mesh.points.n_local(); ++v) {
    const PackedTensor expected = pack(field(geometry.points[v]));
    const Vec3& x = geometry.points[v];
    for (int i = 0; i < tensor_size; ++i) {
      if (x[2] > 1e-9 && x[2] < 0.4 && i >= 4) continue;  // mirrored stencils reach over the plane there only
      EXPECT_NEAR(at_points[std::size_t(v) * tensor_size + i], expected[i], 1e-10) << x.transpose();
    }
  }
}

// Plane stress has no stress across the plane, in cells and on faces alike: what is exact is told to be, and the yield strength
// is compared with the stress in the plane.
TEST(SolidOutput, a_uniform_plane_stress_has_no_error) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
    SolidParameters p = pulled_sheet();
    p.material.yield_strength = 125e6;
    p.method.preconditioner = MethodParameters::Preconditioner::factors;
    for (auto& [name, probe] : p.probes) probe.fields = {"stress"};
    p.probes["low"] = {Vec3(1.1, 0, 0), {"stress"}};
    const auto solid = make_solid(make_box(cells, {20, 8, 1}, Vec3::Zero(), Vec3(2, 1, 0)), p);
    const auto run = support::observe(*solid, 1, 1);
    const auto reported = reported_stresses(solid->body(), solid->fields(), solid->view().output.probes());
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
      EXPECT_EQ(reported.size(), 4u);
    }
    for (const ReportedStress& s : reported) {
      EXPECT_NEAR(s.value, 1e8, 10) << s.where;
      EXPECT_LT(s.error, 1e-6) << name(cells) << " " << s.where;
    }
    EXPECT_THAT(run.finding("yielding").sentence,
                ::testing::HasSubstr("yield strength = 0.8; this changes the result by 0 % "));
  }
}

TEST(SolidOutput, left_out_effects_are_judged_by_numbers) {
  SolidParameters p = pulled_sheet();
  p.probes.clear();
  p.boundaries["xmax"] = boundary(Type::traction, {"1e8*t^2", "0"});
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {6, 4, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  const auto slow = make_solid(raw, p), fast = make_solid(raw, p);
  const auto lines = [](Solid& solid, double dt) {
    std::vector<std::string> texts;
    const auto run = support::observe(solid, 3, dt);
    for (const diagnostics::Finding& f : run.diagnostics().findings())
      texts.push_back(f.sentence + "; " + f.advice);
    return texts;
  };
  EXPECT_THAT(
      lines(*slow, 1),
      ::testing::AllOf(::testing::Contains(::testing::AllOf(::testing::HasSubstr("geometric non-linearity"),
                                                            ::testing::HasSubstr("justified"))),
                       ::testing::Contains(::testing::AllOf(::testing::HasSubstr("inertia neglected"),
                                                            ::testing::HasSubstr("justified")))));
  EXPECT_THAT(lines(*fast, 1e-4), ::testing::Contains(::testing::HasSubstr("use 'analysis: dynamic'")));
}

}  // namespace couplet::testing::output_test
