// SPDX-License-Identifier: Apache-2.0
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::energy_test {
using namespace mesh;
using namespace time;

/// A sheet under everything that does work: traction, pressure, body force, moving support, damping.
SolidParameters busy_sheet(TimeScheme scheme) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 1e5, 0.3};
  p.time_scheme.type = scheme;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"5e-3*sin(2*t)", "0"});
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {"400*sin(4*t)", "300*t*cos(3*t)"});
  p.boundaries["ymax"] = pressed("100*t");
  p.body_force = {{"0"}, {"300*x*sin(2*t)"}};
  p.initial_velocity = {{"1e-2"}, {"0"}};  // that of the support
  p.damping = SolidDamping{0.4, 3e-3};
  p.output.energies = true;
  p.method.relative_tolerance = 1e-12;
  return p;
}

struct Way {
  FaceGradient gradient;
  bool damped;
};
constexpr Way every_way[] = {{FaceGradient::thesis, false},
                             {FaceGradient::thesis, true},
                             {FaceGradient::symmetric, false},
                             {FaceGradient::symmetric, true}};

std::unique_ptr<Solid> run(const SolidParameters& p, int steps, double dt) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {10, 4, 1}, Vec3::Zero(), Vec3(1, 0.4, 0));
  perturb_interior(raw, 0.15, 4);
  auto solid = make_solid(raw, p);
  for (int i = 0; i < steps; ++i) step(*solid, dt);
  return solid;
}

double largest(const SolidEnergies& e) {
  return std::max({std::abs(e.internal_work), std::abs(e.external_work), e.kinetic, e.damping_loss});
}

// Half of the sheet stiffer and heavier; springs, a component that moves, a rail: they do work on the solid.
TEST(SolidEnergy, balances_to_round_off_with_two_materials_and_supports) {
  for (const auto& [gradient, damped] : every_way) {
    SolidParameters p = busy_sheet(TimeScheme::trapezoidal);
    p.method.face_gradient = gradient;
    if (!damped) p.damping.reset();
    p.materials["soft"] = {{1000, 1e5, 0.3, {}}, {}};
    p.materials["hard"] = {{3000, 1e6, 0.2, {}}, {}};
    p.boundaries["xmin"] = boundary(Type::spring, {"5e-3*sin(2*t)", "0"});
    p.boundaries["xmin"].stiffness = {"1e5"};
    SolidBoundary& moved = p.boundaries["ymax"];
    moved = boundary(Type::fixed_displacement);
    moved.components[1] = {"2e-3*sin(3*t)"};
    p.initial_velocity = {{"1e-2"}, {"6e-3*y/0.4"}};
    RawMesh raw = make_box(BoxCells::quadrilaterals, {10, 4, 1}, Vec3::Zero(), Vec3(1, 0.4, 0));
    raw.zones = {"soft", "hard"};
    for (Index c = 0; c < raw.cell_points.size(); ++c)
      raw.cell_zone[c] = raw.points[raw.cell_points[c][0]][0] > 0.45;
    perturb_interior(raw, 0.15, 4);
    const auto solid = make_solid(raw, p);
    ASSERT_FALSE(solid->body().mesh().twin.empty());
    for (int i = 0; i < 80; ++i) step(*solid, 0.02);
    const SolidEnergies e = energies(*solid);
    RecordProperty(fmt::format("imbalance{}{}", gradient == FaceGradient::symmetric ? "" : "_thesis",
                               damped ? "_damped" : ""),
                   fmt::format("{:.2e}", std::abs(e.lost()) / largest(e)));
    EXPECT_LT(std::abs(e.lost()), 1e-9 * largest(e));
    EXPECT_GT(std::abs(e.external_work), 1e-3);
  }
}

TEST(SolidEnergy, balances_to_round_off_for_the_trapezoidal_rule) {
  for (const auto& [gradient, damped] : every_way) {
    SolidParameters p = busy_sheet(TimeScheme::trapezoidal);
    p.method.face_gradient = gradient;
    if (!damped) p.damping.reset();
    const auto solid = run(p, 80, 0.02);
    const SolidEnergies e = energies(*solid);
    fmt::print(
        "kinetic {:.3e}, internal work {:.3e}, strain {:.3e}, external {:.3e}, damping {:.3e}, lost {:.1e} "
        "J\n",
        e.kinetic, e.internal_work, e.strain, e.external_work, e.damping_loss, e.lost());
    RecordProperty(fmt::format("imbalance{}{}", gradient == FaceGradient::symmetric ? "" : "_thesis",
                               damped ? "_damped" : ""),
                   fmt::format("{:.2e}", std::abs(e.lost()) / largest(e)));
    EXPECT_LT(std::abs(e.lost()), 1e-9 * largest(e));
    EXPECT_GT(e.external_work, 0.01);
    EXPECT_EQ(e.damping_loss > 0.01 * largest(e), damped);
    // The strain energy is a function of the state; the operator has a potential only nearly.
    EXPECT_NEAR(e.strain / e.internal_work, 1, gradient == FaceGradient::symmetric && !damped ? 1e-8 : 0.2);
  }
}

// Damping by mass takes alpha v . M v, whose mean over the step is that of v half way: with every operator and at large strain.
TEST(SolidEnergy, balances_to_round_off_under_damping_by_mass_with_every_operator) {
  for (const bool finite : {false, true})
    for (const FaceGradient gradient : {FaceGradient::thesis, FaceGradient::symmetric}) {
      if (finite && gradient != FaceGradient::symmetric) continue;
      SolidParameters p = busy_sheet(TimeScheme::trapezoidal);
      p.damping = SolidDamping{2, 0};
      p.method.face_gradient = gradient;
      if (finite) {  // where the work of a support that moves is not counted
        p.boundaries["xmin"] = clamped(2);
        p.initial_velocity = {{"0.1*x"}, {"0"}};
        p.kinematics = SolidParameters::Kinematics::finite_strain;
        p.boundaries["ymax"] = boundary(Type::free);
      }
      const auto solid = run(p, 40, 0.02);
      SolidEnergies e = energies(*solid);
      e.conserving =
          !finite;  // at large strain the step conserves the strain energy itself, as far as it is solved
      RecordProperty(fmt::format("imbalance_{}_{}", int(gradient), finite),
                     fmt::format("{:.2e}", std::abs(e.lost()) / largest(e)));
      EXPECT_LT(std::abs(e.lost()), (finite ? 1e-3 : 1e-8) * largest(e))
          << int(gradient) << (finite ? " at large strain" : "");
      EXPECT_GT(e.damping_loss, 0.02 * largest(e)) << int(gradient) << (finite ? " at large strain" : "");
    }
}

TEST(SolidEnergy, what_dissipative_schemes_lose_vanishes_with_the_step) {
  for (const TimeScheme scheme :
       {TimeScheme::euler, TimeScheme::three_point, TimeScheme::bathe, TimeScheme::generalised_alpha}) {
    SolidParameters p = busy_sheet(scheme);
    p.damping.reset();
    const auto coarse = run(p, 80, 0.02), fine = run(p, 320, 0.005);
    const SolidEnergies a = energies(*coarse);
    const SolidEnergies b = energies(*fine);
    fmt::print("{}: lost {:.2e} and {:.2e} of {:.2e} J\n", name(scheme), a.lost(), b.lost(), largest(b));
    EXPECT_GT(std::abs(a.lost()), 1e-8 * largest(a)) << name(scheme);
    EXPECT_LT(std::abs(b.lost()), 0.7 * std::abs(a.lost()))
        << name(scheme);  // Euler: not yet linear in the step
  }
}

TEST(SolidEnergy, dissipative_schemes_never_show_a_gain_in_free_vibration) {
  for (const TimeScheme scheme : {TimeScheme::euler, TimeScheme::three_point, TimeScheme::bathe}) {
    SolidParameters p = box_parameters(2);
    p.analysis = SolidParameters::Analysis::dynamic;
    p.material = {1000, 1e5, 0.3};
    p.time_scheme.type = scheme;
    p.method.face_gradient = FaceGradient::symmetric;
    p.method.relative_tolerance = 1e-12;
    p.boundaries["xmin"] = clamped(2);
    p.initial_velocity = {{"0.1*x*sin(9*y)"}, {"0.2*x*x"}};
    p.output.energies = true;
    RawMesh raw = make_box(BoxCells::quadrilaterals, {10, 4, 1}, Vec3::Zero(), Vec3(1, 0.4, 0));
    perturb_interior(raw, 0.15, 4);
    const auto solid = make_solid(raw, p);
    double least = 0;
    for (int i = 0; i < 40; ++i) {
      step(*solid, 0.01);
      const SolidEnergies e = energies(*solid);
      least = std::min(least, e.lost() / e.initial_kinetic);
    }
    const SolidEnergies e = energies(*solid);
    fmt::print("{}: lost {:.2e} of {:.2e} J, least {:.1e}\n", name(scheme), e.lost(), e.initial_kinetic,
               least);
    EXPECT_GT(least, -1e-9) << name(scheme);
    EXPECT_GT(e.lost(), 1e-4 * e.initial_kinetic) << name(scheme);
  }
}

// A drop of a rigid weight: kinetic energy equals the work of gravity.
TEST(SolidEnergy, of_a_falling_body_is_all_kinetic) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {7800, 1e6, 0.3};
  p.gravity = {0, -10};
  p.output.energies = true;
  const auto solid = run(p, 10, 0.1);
  const SolidEnergies e = energies(*solid);
  const double mass = 7800 * 0.4;
  EXPECT_NEAR(e.kinetic / (0.5 * mass * 100), 1, 1e-9);
  EXPECT_NEAR(e.external_work / (0.5 * mass * 100), 1, 1e-9);
  EXPECT_LT(std::abs(e.strain), 1e-9 * e.kinetic);
}

}  // namespace couplet::testing::energy_test
