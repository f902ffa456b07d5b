// SPDX-License-Identifier: Apache-2.0
// The fluid stays bounded whatever step it is asked for: it cuts it into stable parts.
#include "../../verification/fluid/fluid_case.hpp"

namespace couplet::fluid::test::step_sizes_test {
using namespace mesh;
using Case = std::tuple<ViscousTreatment, double>;

class StepSizes : public ::testing::TestWithParam<Case> {};

TEST_P(StepSizes, keep_the_flow_bounded) {
  FluidParameters p = channel(std::get<0>(GetParam()), 1e-8);
  FluidCase<2> c(MPI_COMM_WORLD, channel_mesh(), p);
  for (int i = 0; i < 4; ++i) c.step(std::get<1>(GetParam()));
  double largest = 0;
  for (const Vec<2>& u : c.state().u) largest = std::max(largest, u.norm());
  EXPECT_LT(largest, 3);
  EXPECT_GT(largest, 0.5);
}

INSTANTIATE_TEST_SUITE_P(from_tiny_to_huge, StepSizes,
                         ::testing::Combine(::testing::Values(ViscousTreatment::explicit_,
                                                              ViscousTreatment::implicit,
                                                              ViscousTreatment::automatic),
                                            ::testing::Values(1e-9, 1e-5, 1e-2, 1.0, 5.0)));

class DistortedCells : public ::testing::TestWithParam<std::tuple<BoxCells, double, ViscousTreatment>> {};

TEST_P(DistortedCells, keep_the_channel_flow_near_its_profile) {
  const auto [cells, amount, viscous] = GetParam();
  const bool flat = cells == BoxCells::quadrilaterals || cells == BoxCells::triangles;
  FluidParameters p = fluid_of(1.3, 0.05, 1e-7);
  p.viscous = viscous;
  const std::vector<std::string> profile{"4*y*(1-y)", "0", "0"};
  p.boundaries["zmin"] = p.boundaries["zmax"] = boundary(BoundaryType::slip);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  const auto check = [&]<int D>(std::integral_constant<int, D>) {
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {profile.begin(), profile.begin() + D});
    if (D == 2)
      for (const char* side : {"zmin", "zmax"}) p.boundaries.erase(side);
    RawMesh raw =
        make_box(cells, D == 2 ? std::array{24, 12, 1} : std::array{10, 6, 3}, Vec3::Zero(), Vec3(2, 1, 0.5));
    perturb_interior(raw, amount, 7);
    FluidCase<D> c(MPI_COMM_WORLD, raw, p);
    c.run(1.2, 30);
    return c.velocity_error([](const Vec3& x) { return Vec3(4 * x.y() * (1 - x.y()), 0, 0); });
  };
  const double error =
      flat ? check(std::integral_constant<int, 2>{}) : check(std::integral_constant<int, 3>{});
  printf("distorted channel: %.2e\n", error);
  EXPECT_LT(error, flat ? 0.03 : 0.12);
}

INSTANTIATE_TEST_SUITE_P(
    of_all_kinds, DistortedCells,
    ::testing::Combine(::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                         BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed),
                       ::testing::Values(0.0, 0.15, 0.2),
                       ::testing::Values(ViscousTreatment::explicit_, ViscousTreatment::implicit)));

TEST(FixedStep, beyond_the_stability_limit_is_a_failure_that_names_the_place) {
  FluidParameters p = channel(ViscousTreatment::explicit_, 1e-8);
  p.time_step = 0.5;
  FluidCase<2> c(MPI_COMM_WORLD, channel_mesh(), p);
  try {
    c.run(100, 200);
    FAIL() << "the step is far beyond the limit";
  } catch (const couplet::SolveFailure& failure) {
    EXPECT_THAT(failure.what(), ::testing::HasSubstr("in cell"));
    EXPECT_THAT(failure.what(), ::testing::HasSubstr("step of"));
  }
}

// The step that the eigenvalue bounds allow is stable, and hardly shorter than need be.

double largest_speed(const FluidCase<2>& c) {
  double largest = 0;
  for (const Vec<2>& u : c.state().u) largest = std::max(largest, u.norm());
  return largest;
}

/// Growth of noise in a viscous fluid at rest over 400 steps of a share of the limit. The fastest decay of
/// even squares, 8 nu/h^2, is the bound itself.
double growth_of_noise(double share_of_limit) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {24, 24, 1}, Vec3::Zero(), Vec3::Ones());
  raw.periodic = {{"xmin", "xmax"}, {"ymin", "ymax"}};
  const double noise = 1e-3;
  FluidParameters p = fluid_of(1, 0.1);
  p.viscous = ViscousTreatment::explicit_;
  p.time_step = 1;  // the steps below are shorter: they are not cut
  p.pressure_tolerance = 1e-10;
  p.initial_velocity = {{"1e-3*sin(300*x+170*y)*cos(430*y)"}, {"1e-3*cos(290*x-410*y)"}};
  all_sides(p, 2, boundary(BoundaryType::periodic));
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  const MomentumTerms<2> none;
  StepSize<2> sizes(c.mesh(), c.fluid().boundary(), p.viscosity / p.density, none);
  const double dt = share_of_limit * sizes.limits(c.state()).explicit_viscous;
  try {
    for (int i = 0; i < 400; ++i) c.step(dt);
  } catch (const SolveFailure&) {
    return std::numeric_limits<double>::infinity();
  }
  return largest_speed(c) / noise;
}

TEST(StepLimit, of_explicit_diffusion_is_the_longest_stable_step) {
  EXPECT_LT(growth_of_noise(1), 1);
  EXPECT_GT(growth_of_noise(1.02), 10);
}

/// What a uniform eddy viscosity does not allow is what no fluid of that viscosity is allowed: nu + 2 nu_t, as the stress
/// nu_t (grad u + grad u^T) may have twice the rate of nu_t grad u.
TEST(StepLimit, of_eddy_viscosity_is_that_of_a_more_viscous_fluid) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {8, 8, 1}, Vec3::Zero(), Vec3::Ones());
  perturb_interior(raw, 0.2, 3);
  raw.periodic = {{"xmin", "xmax"}, {"ymin", "ymax"}};
  FluidParameters p = fluid_of(1, 0.1);
  p.viscous = ViscousTreatment::explicit_;
  p.initial_velocity = {{"2"}, {"1"}};
  all_sides(p, 2, boundary(BoundaryType::periodic));
  FluidCase<2> c(MPI_COMM_WORLD, raw, p), thick(MPI_COMM_WORLD, raw, p);
  p.turbulence.emplace();
  const MomentumTerms<2> none, eddies = make_momentum_terms<2>(c.mesh(), c.fluid().boundary(), p);
  StepSize<2> sizes(c.mesh(), thick.fluid().boundary(), 0.1, none),
      of_eddies(c.mesh(), thick.fluid().boundary(), 0.1, eddies),
      of_thick(c.mesh(), thick.fluid().boundary(), 0.7, none);
  State<2> eddying = c.state();
  eddying.eddy.assign(std::size_t(c.mesh().cells.n_local()), 0.3);
  const double limit = of_eddies.limits(eddying).explicit_viscous;
  EXPECT_NEAR(limit, of_thick.limits(c.state()).explicit_viscous, 1e-5 * limit);
  EXPECT_LT(limit, 0.5 * sizes.limits(c.state()).explicit_viscous);
}

/// Velocities in a cavity of size 1 with a lid of speed 1 and cells that shrink toward the walls, after `steps` steps to `time`.
Vectors<2> cavity(double nu, double time, int steps, ViscousTreatment viscous,
                  std::vector<config::ExpressionText> initial = {}) {
  FluidParameters p = fluid_of(1, nu, 1e-8);
  p.viscous = viscous;
  p.initial_velocity = std::move(initial);
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  RawMesh raw = make_box(BoxCells::quadrilaterals, {16, 16, 1}, Vec3::Zero(), Vec3::Ones());
  for (Vec3& x : raw.points)
    for (int c = 0; c < 2; ++c) x[c] -= std::sin(2 * std::numbers::pi * x[c]) / (2.5 * std::numbers::pi);
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(time, steps);
  return {c.state().u.begin(), c.state().u.begin() + c.mesh().cells.n_owned()};
}
double apart(const Vectors<2>& a, const Vectors<2>& b) {
  double sums[2] = {};
  for (std::size_t i = 0; i < a.size(); ++i)
    sums[0] += (a[i] - b[i]).squaredNorm(), sums[1] += b[i].squaredNorm();
  return std::sqrt(sums[0] / sums[1]);
}

/// Implicit steps beyond the decay of the flux memory lost 2 % of the velocity to the corners.
TEST(SubSteps, do_not_change_a_steady_flow) {
  const Vectors<2> fine = cavity(0.01, 20, 4000, ViscousTreatment::explicit_);
  EXPECT_LT(apart(cavity(0.01, 20, 200, ViscousTreatment::implicit), fine), 1e-5);
}

/// Without the friction of the projection, long steps were 1e-3 from the steady flow after 100 of them.
TEST(SubSteps, of_much_friction_settle) {
  EXPECT_LT(
      apart(cavity(1, 10, 100, ViscousTreatment::implicit), cavity(1, 100, 1000, ViscousTreatment::implicit)),
      1e-5);
}

/// A fluid at rest has no limit of its own: its first step was one sub-step, with 6 % left after four steps.
TEST(SubSteps, are_those_of_the_flow_that_starts) {
  const Vectors<2> fine = cavity(0.001, 3, 800, ViscousTreatment::automatic);
  EXPECT_LT(apart(cavity(0.001, 3, 4, ViscousTreatment::automatic), fine), 3e-3);
  EXPECT_LT(apart(cavity(0.001, 3, 4, ViscousTreatment::automatic, {{"0"}, {"0"}}), fine), 3e-3);
}

/// Lid-driven cavity, Re = 1000, that chooses its steps itself, first cautiously until the flow has developed
/// near the lid: largest speed in the cells. The steady flow in them is slower than the lid.
double speed_in_cavity(double safety_factor, ViscousTreatment viscous) {
  FluidParameters p = fluid_of(1, 1e-3, 1e-5);
  p.viscous = viscous;
  p.safety_factor = safety_factor;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {40, 40, 1}, Vec3::Zero(), Vec3::Ones()),
                 p);
  try {
    c.step(1e-3);
    for (int i = 0; i < 4; ++i) c.step(10);
  } catch (const SolveFailure&) {
    return std::numeric_limits<double>::infinity();
  }
  EXPECT_GT(c.fluid().statistics().all_sub_steps, 200);
  return largest_speed(c);
}

TEST(StepLimit, of_a_cavity_keeps_it_steady_and_leaves_less_than_a_third_unused) {
  const double steady = speed_in_cavity(0.8, ViscousTreatment::explicit_);
  EXPECT_LT(steady, 0.9);
  EXPECT_NEAR(speed_in_cavity(1, ViscousTreatment::explicit_), steady, 0.01 * steady);
  EXPECT_NEAR(speed_in_cavity(1, ViscousTreatment::implicit), steady, 0.01 * steady);
  EXPECT_GT(speed_in_cavity(1.3, ViscousTreatment::explicit_), 1.03 * steady);
}

/// Who is named as the cell that limits the step has the limit of the step, and is where the cells are small.
TEST(StepLimit, the_cell_that_limits_the_step_is_named_with_its_place_and_the_reason) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {20, 4, 1}, Vec3::Zero(), Vec3(1, 1, 1));
  for (Vec3& x : raw.points) x.x() = std::pow(x.x(), 2);  // small cells at x = 0
  for (const bool viscous : {false, true}) {
    FluidParameters p = fluid_of(1, viscous ? 1 : 1e-6);
    p.viscous = ViscousTreatment::explicit_;
    p.initial_velocity = {{"1"}, {"0"}};
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"1", "0"});
    p.boundaries["xmax"] = boundary(BoundaryType::outlet);
    p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
    FluidCase<2> c(MPI_COMM_WORLD, raw, p);
    const MomentumTerms<2> none;
    StepSize<2> sizes(c.mesh(), c.fluid().boundary(), p.viscosity / p.density, none);
    const double limit = sizes.limits(c.state()).explicit_viscous;
    const StepLimiter found = sizes.limiter(c.state(), false);
    EXPECT_NEAR(found.limit, limit, 1e-5 * limit);  // that is rounded down to six digits
    EXPECT_LT(found.place.x(), 0.0026);             // in the first column of cells
    EXPECT_EQ(found.friction, viscous);
    const double implicit = sizes.limits(c.state()).implicit_viscous;
    EXPECT_NEAR(sizes.limiter(c.state(), true).limit, implicit, 1e-5 * implicit);
  }
}

}  // namespace couplet::fluid::test::step_sizes_test
