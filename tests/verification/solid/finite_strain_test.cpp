// SPDX-License-Identifier: Apache-2.0
// Large strain: bending against converged references, rigid rotation, Newton's tail, ranks, restart, refusals.
#include "solid_solver/equilibrium/finite_strain.hpp"
#include "solid_solver/laws/laws.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/finite_support.hpp"

namespace couplet::testing::finite_strain_test {
using namespace mesh;
using namespace parallel;

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr double side = beam_side, length = beam_length;

SolidParameters bent(const std::string& law, double K) {
  SolidParameters p = box_parameters(3);
  p.material = {1000, 15.293e6, 0.3};
  p.material.law = law;
  return testing::bent(p, K);
}

TEST(FiniteStrain, bends_as_converged_finite_elements_do) {
  const auto svk = stepped(beam(2, 20), bent("saint-venant-kirchhoff", 1.6));
  EXPECT_NEAR(deflection(*svk), 0.43134, 0.01 * 0.43134);
  const auto neo = stepped(beam(2, 20), bent("neo-hookean", 1.6));
  EXPECT_NEAR(deflection(*neo), 0.430758, 0.01 * 0.43);
}

/// Compares the tip with that of a mesh twice as fine. One row of cells shows no slope of its bending.
TEST(FiniteStrain, the_estimate_of_the_mesh_is_at_least_half_of_the_truth_or_unknown) {
  if (comm_size(MPI_COMM_WORLD) > 2) return;  // its many linear iterations wait for each other on few cores
  const auto tip = [](const Solid& solid) {
    return displacement_at(solid, Vec3(side / 2, side / 2, length));
  };
  const auto told = [](Solid& solid) { return support::observe(solid, 1, 1).diagnostics().errors().mesh; };
  EXPECT_TRUE(std::isnan(told(*make_solid(beam(1, 10), bent("neo-hookean", 0.1)))));
  for (const double K : {0.1, 1.6}) {
    const auto coarse = make_solid(beam(2, 20), bent("neo-hookean", K)),
               fine = make_solid(beam(4, 40), bent("neo-hookean", K));
    const double mesh = told(*coarse);
    step(*fine, 1);
    const double wrong = (tip(*coarse) - tip(*fine)).norm() / tip(*fine).norm();
    fmt::print("K {}: estimated {:.3g}, true {:.3g}\n", K, mesh, wrong);
    EXPECT_GT(mesh, wrong / 2) << K;
    EXPECT_LT(mesh, wrong * 5) << K;
  }
}

TEST(FiniteStrain, equals_small_strain_under_small_loads) {
  SolidParameters p = bent("", 1e-6);
  const auto large = make_solid(beam(2, 20), p);
  p.kinematics = SolidParameters::Kinematics::small_strain;
  p.method.face_gradient = FaceGradient::symmetric;
  const auto small = make_solid(beam(2, 20), p);
  step(*large, 1);
  step(*small, 1);
  EXPECT_NEAR(deflection(*large), deflection(*small), 1e-5 * deflection(*small));
}

// Residuals square from one iteration to the next near the end, less what the inexact solves leave.
TEST(FiniteStrain, newton_ends_superlinearly) {
  const auto solid = stepped(beam(2, 20), bent("neo-hookean", 1));
  const auto& tail = dynamic_cast<const FiniteStrain&>(solid->body().equilibrium()).iterates();
  ASSERT_GE(tail.size(), 4U);
  EXPECT_LE(tail.size(), 12U);
  bool seen = false;
  for (std::size_t i = 1; i < tail.size(); ++i) seen = seen || tail[i].residual < 2e-3 * tail[i - 1].residual;
  EXPECT_TRUE(seen);
}

TEST(FiniteStrain, ranks_agree) {
  const RawMesh raw = beam(2, 20);
  const auto whole = make_solid(raw, bent("neo-hookean", 1), MPI_COMM_SELF),
             parts = make_solid(raw, bent("neo-hookean", 1));
  step(*whole, 1);
  step(*parts, 1);
  EXPECT_NEAR(deflection(*parts), deflection(*whole), 1e-8 * deflection(*whole));
}

/// A homogeneous deformation is met exactly on any cells, and the stress is the law's.
TEST(FiniteStrain, homogeneous_deformation_is_exact) {
  SolidParameters p = box_parameters(3);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, 1e6, 0.3};
  p.material.law = "nearly-incompressible-neo-hookean";
  Tensor3 g;
  g << 0.3, 0.1, 0, -0.2, 0.1, 0.05, 0.1, 0, -0.2;
  const auto row = [&](int a) { return fmt::format("{}*x + {}*y + {}*z", g(a, 0), g(a, 1), g(a, 2)); };
  for (const char* name : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    p.boundaries[name] = boundary(Type::fixed_displacement, {row(0), row(1), row(2)});
  const Tensor3 f = Tensor3::Identity() + g, b = f * f.transpose();
  const double j = f.determinant(), mu = 1e6 / 2.6, K = 1e6 / 1.2;
  const Tensor3 wanted = K * (j - 1) * Tensor3::Identity() +
                         mu * std::pow(j, -5. / 3) * (b - b.trace() / 3 * Tensor3::Identity());
  for (const auto volume : {MethodParameters::VolumeStrain::faces, MethodParameters::VolumeStrain::cells})
    for (const BoxCells cells :
         {BoxCells::hexahedra, BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed}) {
      p.method.volume_strain = volume;
      RawMesh raw = make_box(cells, {3, 3, 3}, Vec3::Zero(), Vec3::Ones());
      perturb_interior(raw, 0.15, 7);
      const auto solid = stepped(raw, p);
      for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
        EXPECT_LT((s - wanted).cwiseAbs().maxCoeff(), 1e-8 * wanted.norm());
    }
}

/// A bar of Saint Venant and Kirchhoff's law, nu = 0, that carries P = E l (l^2 - 1) / 2 at the stretch l: were it softer it
/// would give way by P / (dP/dl) = l (l^2 - 1) / (3 l^2 - 1). Pulled it stiffens, P (l - 1) > 2 W, and is loaded as a whole.
TEST(FiniteStrain, a_stretched_bar_gives_way_by_its_tangent) {
  for (const double pull : {0.9375e6, -0.144e6}) {  // stretches 1.5 and 0.8
    SolidParameters p = box_parameters(2);
    p.kinematics = SolidParameters::Kinematics::finite_strain;
    p.material = {1000, 1e6, 0};
    p.material.law = "saint-venant-kirchhoff";
    for (const char* side : {"xmin", "ymin", "ymax"}) p.boundaries[side] = boundary(Type::symmetry);
    p.boundaries["xmax"] = boundary(Type::traction, {fmt::format("{}*t", pull), "0"});
    const auto solid =
        make_solid(make_box(BoxCells::quadrilaterals, {6, 2, 1}, Vec3::Zero(), Vec3(1, 0.3, 0)), p);
    for (int i = 0; i < 4; ++i) step(*solid, 0.25);
    const SolidState& s = solid->stepper().state();
    const double l = pull > 0 ? 1.5 : 0.8, ratio = l * (l + 1) / (3 * l * l - 1),
                 loaded = std::min(1., 2 * l / (l + 1));
    const double found =
        solid->body().finite_strain()->softness(solid->body().unknowns_of(s.cell_u, s.face_u), s.known);
    EXPECT_NEAR(found, loaded * ratio + 1 - loaded, 0.01) << l;
  }
}

TEST(FiniteStrain, restart_in_the_middle_of_the_load_is_bit_for_bit) {
  expect_same_after_restart(beam(2, 20), bent("neo-hookean", 4), 0.25, 0.5);
}

TEST(FiniteStrain, failed_load_names_the_worst_cell_and_leaves_the_state) {
  if (comm_size(MPI_COMM_WORLD) > 2) return;  // its many linear iterations wait for each other on few cores
  const auto solid = make_solid(beam(2, 20), bent("saint-venant-kirchhoff", 1));
  step(*solid, 0.5);
  const std::vector<double> kept = solid->stepper().state().cell_u;
  solid->begin_step({0.5, 400, coupling::Scheme::standalone, 1});
  EXPECT_THAT([&] { solid->solve({}); }, ThrowsMessage<SolveFailure>(HasSubstr("where det F =")));
  EXPECT_EQ(solid->stepper().state().cell_u, kept);
  step(*solid, 0.1);
}

TEST(FiniteStrain, reactions_balance_the_load) {
  const auto solid = stepped(beam(2, 20), bent("neo-hookean", 1));
  const auto reactions = solid->fields().reactions(solid->fields().point_displacement());
  const Vec3 load = solid->fields().total_load();
  ASSERT_EQ(reactions.size(), 1U);
  EXPECT_LT((reactions[0].force + load).norm(), 1e-8 * load.norm());
}

constexpr std::array kinds{BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                           BoxCells::tetrahedra,     BoxCells::prisms,    BoxCells::mixed};

// Forces are the energy's derivative, the tangent is the forces', and symmetric but for the pressure's rim.
TEST(FiniteStrain, tangent_is_the_derivative_of_the_forces_on_all_cells) {
  for (const auto volume : {MethodParameters::VolumeStrain::faces, MethodParameters::VolumeStrain::cells})
    for (const BoxCells cells : kinds) {
      const int dim = dimension_of(cells);
      RawMesh raw = make_box(cells, {3, 2, 3}, Vec3::Zero(), dim == 2 ? Vec3(1, 1, 0) : Vec3(1, 1, 1));
      perturb_interior(raw, 0.1, 3);
      const auto solid = make_solid(raw, busy(dim, volume));
      const auto law =
          laws::find("mooney-rivlin")->make(lame_constants(solid->body().parameters()), std::vector{0.3});
      const auto kernel = std::make_unique<elastic::FiniteKernel>(solid->body().mesh(),
                                                                  solid->body().elastic(), std::vector{law});
      const std::size_t n = solid->body().elastic().n_unknowns();
      expect_derivatives(*kernel, n);
      std::vector<double> pressure(solid->body().mesh().boundary.n_owned(), 0);
      for (Index f = solid->body().mesh().n_interior; f < solid->body().mesh().n_flux_faces(); ++f)
        if (solid->body().geometry().face_centre[f][1] > 1 - 1e-9)
          pressure[f - solid->body().mesh().n_interior] = 3e5;
      kernel->set_pressure(pressure);
      expect_derivatives(*kernel, n, false);
    }
}

/// A quarter of a bonded rubber block, pressed to `squeezed` of its half height of 0.5 and then, in one step, to more than
/// all of it: why that, or a step on the way, fails.
std::string failure_of_block(double squeezed, int cells = 8, double by = 0.025) {
  SolidParameters p = box_parameters(2);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, 3e6, 0.4999};
  p.material.law = "nearly-incompressible-neo-hookean";
  p.boundaries["xmin"] = p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["ymax"] = boundary(Type::fixed_displacement, {"0", "-t"});
  const auto solid =
      make_solid(make_box(BoxCells::quadrilaterals, {cells, cells, 1}, Vec3::Zero(), Vec3(0.5, 0.5, 0)), p);
  const int n = int(std::lround(squeezed / by));
  try {
    for (int i = 0; i < n; ++i) step(*solid, by);
    solid->begin_step({squeezed, 0.6, coupling::Scheme::standalone, n});
    solid->solve({});
  } catch (const SolveFailure& failure) {
    return failure.what();
  }
  return "none";
}

TEST(FiniteStrain, a_step_that_fails_tells_of_a_surface_folded_onto_its_support) {
  const std::string fold = "Next to 'ymax' the free surface has folded past the plane of the support";
  EXPECT_THAT(failure_of_block(0.2), HasSubstr(fold));
  // Here the face at the rim itself is pressed flat; those beside it fold.
  EXPECT_THAT(failure_of_block(0.165, 16, 0.0055), HasSubstr(fold));
  const std::string upright = failure_of_block(0.025);
  EXPECT_NE(upright, "none");
  EXPECT_THAT(upright, Not(HasSubstr("folded")));
}

}  // namespace couplet::testing::finite_strain_test
