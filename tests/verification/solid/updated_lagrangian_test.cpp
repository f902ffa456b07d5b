// SPDX-License-Identifier: Apache-2.0
// The thesis's own method at large strain: its printed deflections, frames, exactness, ranks, restart, refusals.
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/finite_support.hpp"

namespace couplet::testing::updated_lagrangian_test {
using namespace mesh;
using namespace parallel;

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double E = 15.293e6;

SolidParameters large(const std::string& law) {
  SolidParameters p = box_parameters(3);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, E, 0.3};
  p.material.law = law;
  p.method.type = MethodParameters::Type::segregated;
  p.method.max_iterations = 20000;
  return p;
}

SolidParameters bent(double K) { return testing::bent(large("saint-venant-kirchhoff"), K); }

// Table 3.6, mesh 1. In one load step the frame is the undeformed body (total Lagrangian), in four it moves along.
TEST(UpdatedLagrangian, repeats_the_printed_deflections_in_both_frames) {
  SolidParameters p = bent(1.6);
  if (comm_size(MPI_COMM_WORLD) > 1) return;  // ranks have tests of their own below
  p.method.relative_tolerance = 1e-6;
  p.method.acceleration = MethodParameters::Acceleration::aitken;
  const auto total = stepped(beam(2, 20), p);
  EXPECT_NEAR(deflection(*total), 0.3922, 0.001 * 0.3922);
  p.method.acceleration = MethodParameters::Acceleration::anderson;
  const auto updated = make_solid(beam(2, 20), p);
  for (int i = 0; i < 2; ++i) step(*updated, 0.5);
  EXPECT_NEAR(deflection(*updated), 0.3922, 0.001 * 0.3922);
  EXPECT_NEAR(deflection(*updated), deflection(*total), 2e-4 * 0.3922);
  EXPECT_NE(deflection(*updated), deflection(*total));
}

TEST(UpdatedLagrangian, equals_small_strain_under_small_loads) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  SolidParameters p = bent(1e-6);
  const auto finite = make_solid(beam(2, 10), p);
  p.kinematics = SolidParameters::Kinematics::small_strain;
  p.method.face_gradient = FaceGradient::thesis;
  const auto small = make_solid(beam(2, 10), p);
  step(*finite, 1);
  step(*small, 1);
  EXPECT_NEAR(deflection(*finite), deflection(*small), 1e-5 * deflection(*small));
}

/// A homogeneous deformation grows in two steps on cells that lean: F = f F_u is exact and the stress the law's.
TEST(UpdatedLagrangian, homogeneous_deformation_is_exact_over_two_steps) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  SolidParameters p = large("nearly-incompressible-neo-hookean");
  p.method.relative_tolerance = 1e-8;
  Tensor3 g;
  g << 0.3, 0.1, 0, -0.2, 0.1, 0.05, 0.1, 0, -0.2;
  const auto row = [&](int a) { return fmt::format("t*({}*x + {}*y + {}*z)", g(a, 0), g(a, 1), g(a, 2)); };
  for (const char* name : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    p.boundaries[name] = boundary(Type::fixed_displacement, {row(0), row(1), row(2)});
  const Tensor3 f = Tensor3::Identity() + g, b = f * f.transpose();
  const double j = f.determinant(), mu = E / 2.6, K = E / 1.2;
  const Tensor3 wanted = K * (j - 1) * Tensor3::Identity() +
                         mu * std::pow(j, -5. / 3) * (b - b.trace() / 3 * Tensor3::Identity());
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra}) {
    RawMesh raw = make_box(cells, {2, 2, 2}, Vec3::Zero(), Vec3::Ones());
    perturb_interior(raw, 0.15, 7);
    const auto solid = make_solid(raw, p);
    step(*solid, 0.5);
    step(*solid, 0.5);
    for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
      EXPECT_LT((s - wanted).cwiseAbs().maxCoeff(), 1e-7 * wanted.norm());
  }
}

/// A cube on three planes of symmetry that a pressure squeezes: its force follows the surface, as Newton's has it.
TEST(UpdatedLagrangian, pressure_follows_the_surface_as_with_newton) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  SolidParameters p = large("neo-hookean");
  for (const char* name : {"xmin", "ymin", "zmin"}) p.boundaries[name] = boundary(Type::symmetry);
  p.boundaries["zmax"] = pressed(fmt::format("{}*t", 0.4 * E));
  const auto by = [&](MethodParameters::Type type) {
    p.method.type = type;
    auto solid = make_solid(make_box(BoxCells::hexahedra, {2, 2, 2}, Vec3::Zero(), Vec3::Ones()), p);
    step(*solid, 0.5);
    step(*solid, 0.5);
    const auto held = solid->fields().reactions(solid->fields().point_displacement());
    Vec3 all = solid->fields().total_load();
    EXPECT_GT(all.norm(), 0.4 * E);  // wider than it was
    for (const PatchForce& one : held) all += one.force;
    EXPECT_LT(all.norm(), 1e-7 * E);
    return solid;
  };
  const auto mine = by(MethodParameters::Type::segregated), newton = by(MethodParameters::Type::automatic);
  const auto &u = mine->stepper().state().cell_u, &v = newton->stepper().state().cell_u;
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_NEAR(u[i], v[i], 1e-7);
}

/// A stub in place of a beam: a fifth as long and loaded by so much more, it takes some dozens of iterations.
RawMesh stub() {
  return make_box(BoxCells::hexahedra, {2, 2, 3}, Vec3(-beam_side / 2, -beam_side / 2, beam_length - 0.4),
                  Vec3(beam_side / 2, beam_side / 2, beam_length));
}

TEST(UpdatedLagrangian, ranks_agree) {
  SolidParameters p = bent(20);
  p.method.relative_tolerance = 1e-9;
  const auto whole = make_solid(stub(), p, MPI_COMM_SELF), parts = make_solid(stub(), p);
  for (int i = 0; i < 2; ++i) step(*whole, 0.5), step(*parts, 0.5);
  EXPECT_GT(deflection(*whole), 0.01);
  EXPECT_NEAR(deflection(*parts), deflection(*whole), 1e-8 * deflection(*whole));
}

TEST(UpdatedLagrangian, restart_in_the_middle_of_the_load_is_bit_for_bit) {
  SolidParameters p = bent(20);
  p.method.relative_tolerance = 1e-3;
  expect_same_after_restart(stub(), p, 0.5, 0.5);
}

/// Swings like Newton's method on the other gradient: within what the gradients differ by on such cells.
TEST(UpdatedLagrangian, swings_as_newton_does) {
  if (comm_size(MPI_COMM_WORLD) > 1) return;
  SolidParameters p = large("neo-hookean");
  p.analysis = SolidParameters::Analysis::dynamic;
  p.boundaries["zmin"] = clamped(3);
  p.initial_velocity = {{"10*z"}, {"0"}, {"0"}};
  p.method.relative_tolerance = 1e-7;
  const auto tip = [&](MethodParameters::Type type) {
    p.method.type = type;
    const auto solid =
        make_solid(make_box(BoxCells::hexahedra, {3, 3, 9}, Vec3::Zero(), Vec3(0.2, 0.2, 0.6)), p);
    for (int i = 0; i < 5; ++i) step(*solid, 0.002);
    double most = 0;
    for (const double u : solid->fields().point_displacement()) most = std::max(most, u);
    return max(MPI_COMM_WORLD, most);
  };
  const double mine = tip(MethodParameters::Type::segregated),
               newton = tip(MethodParameters::Type::automatic);
  EXPECT_GT(newton, 0.03);
  EXPECT_NEAR(mine, newton, 0.02 * newton);
}

TEST(UpdatedLagrangian, says_what_it_cannot) {
  SolidParameters p = bent(1);
  p.boundaries["xmin"] = boundary(Type::spring);
  p.boundaries["xmin"].stiffness.text = "1e6";
  EXPECT_THAT([&] { make_solid(beam(2, 2), p); },
              ThrowsMessage<Error>(HasSubstr("not a support or springs")));
  p = bent(1);
  p.method.max_iterations = 5;
  const auto solid = make_solid(beam(2, 10), p);
  solid->begin_step({0, 1, coupling::Scheme::standalone, 0});
  EXPECT_THAT([&] { solid->solve({}); },
              ThrowsMessage<SolveFailure>(HasSubstr("'solution-method.max-iterations'")));
}

}  // namespace couplet::testing::updated_lagrangian_test
