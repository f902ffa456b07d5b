// SPDX-License-Identifier: Apache-2.0
// A flow that gains energy from nowhere fails in solve, by name, and leaves level n; one that is driven does
// not.
#include "../../verification/fluid/fluid_case.hpp"

namespace couplet::fluid::test::energy_growth_test {
using testing::HasSubstr;

/// Shear layers in a box of 1 m whose explicit viscous term is stable up to about 0.01 s.
FluidParameters layers() {
  FluidParameters p = fluid_of(1, 0.01);
  p.viscous = ViscousTreatment::explicit_;
  p.initial_velocity = {{"sin(6*y)"}, {"0.01*sin(9*x)"}};
  all_sides(p, 2, boundary(BoundaryType::slip));
  return p;
}
mesh::RawMesh box(int n) {
  return mesh::make_box(mesh::BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3::Ones());
}

TEST(EnergyGuard, an_explicit_viscous_term_beyond_its_limit_fails_by_name_and_leaves_level_n) {
  FluidParameters p = layers();
  p.time_step = 1;
  FluidCase<2> c(MPI_COMM_WORLD, box(32), p);
  Vectors<2> before;
  double time = -1;
  const std::string said = support::error_of<SolveFailure>([&] {
    for (int i = 0; i < 10; ++i) {
      before = c.state().u;
      time = c.state().time;
      c.step(1);
    }
  });
  EXPECT_THAT(said, HasSubstr("explicit viscous term is stable there up to a step of"));
  EXPECT_THAT(said, HasSubstr("in cell"));
  EXPECT_THAT(said, HasSubstr("kinetic energy grew by"));
  EXPECT_EQ(c.state().u, before);
  EXPECT_EQ(c.state().time, time);
  EXPECT_LT(c.state().ledger.energy, 1) << "accepted energy, of 0.25 J at the start";
}

TEST(EnergyGuard, the_same_flow_within_the_limit_goes_through) {
  FluidCase<2> c(MPI_COMM_WORLD, box(32), layers());
  c.run(1, 20);
  EXPECT_LT(c.state().ledger.excess, 1e-3 * c.state().ledger.energy);
}

// Friction with four neighbours is 4 nu / h^2; with three and a wall at half the distance 5 nu / h^2, or 3 nu / h^2 without friction.
TEST(EnergyGuard, the_step_that_it_names_counts_the_friction_at_walls) {
  FluidParameters p = fluid_of(1, 0.01);
  p.viscous = ViscousTreatment::explicit_;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::slip);
  FluidCase<2> c(MPI_COMM_WORLD, box(8), p);
  c.step(1e-3);
  const State<2>& s = c.state();
  const std::vector<double> none;
  const EnergyStep<2> step{s, *s.placement, 1, s.u, s.w, s.phi, none, none, {}, {}, *s.pressure[0]};
  const auto named = [&](int row) {
    double limit = 0;
    for (Index k = 0; k < c.mesh().cells.n_owned(); ++k) {
      if ((s.placement->centre[k] - Vec<2>(3.5, row + 0.5) / 8).norm() > 1e-9) continue;
      const std::string text = likely_cause<2>(c.mesh(), c.fluid().boundary(), step, k, 0.01, false);
      const std::string before = "stable there up to a step of ";
      EXPECT_THAT(text, HasSubstr(before));
      limit = std::stod(text.substr(text.find(before) + before.size()));
    }
    return parallel::max(MPI_COMM_WORLD, limit);
  };
  EXPECT_NEAR(named(3) / named(0), 5. / 4, 0.01);
  EXPECT_NEAR(named(3) / named(7), 3. / 4, 0.01);
}

/// What is said by a channel of 8 x 8 cells that is fed so.
std::string said(const std::string& inflow, double first_step) {
  FluidParameters p = fluid_of(1, 0.01);
  all_sides(p, 2, boundary(BoundaryType::slip));
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {inflow, "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  return support::error_of<SolveFailure>([&] {
    FluidCase<2> c(MPI_COMM_WORLD, box(8), p);
    for (int i = 0; i < 3; ++i) c.step(first_step);
  });
}

TEST(EnergyGuard, fluxes_out_of_all_bounds_are_named_by_field_cell_and_place) {
  // In the row of cells at the inlet, the second from below.
  const std::string text = said("y > 0.13 && y < 0.24 ? 1e200 : 1", 0.01);
  EXPECT_THAT(text, HasSubstr("fluxes of the pressure equation are out of range"));
  EXPECT_THAT(text, HasSubstr("in cell 8 at (0.0625, 0.1875, 0) m"));
  EXPECT_EQ(said("y > 0.13 && y < 0.24 ? 2 : 1", 0.01), "");
}

TEST(EnergyGuard, too_many_sub_steps_are_named_by_cause_cell_and_place) {
  const std::string text = said("t > 0.015 && y > 0.13 && y < 0.24 ? 1e9 : 1", 0.01);
  EXPECT_THAT(text, HasSubstr("more than 100000 sub-steps"));
  EXPECT_THAT(text, HasSubstr("In cell 8 at (0.0625, 0.1875, 0) m, convection limits them to this size"));
  EXPECT_EQ(said("t > 0.015 && y > 0.13 && y < 0.24 ? 2 : 1", 0.01), "");
}

/// A fluid that is pushed through a duct, as one body: what pressure does at the inlet, less what flows out and with what flows
/// in, is its kinetic energy; also where it leaves with a given velocity and not at a given pressure.
TEST(EnergyGuard, the_work_on_a_fluid_that_is_pushed_through_is_its_kinetic_energy) {
  for (const bool given : {false, true}) {
    FluidParameters p = fluid_of(1.3, 1e-3);
    all_sides(p, 2, boundary(BoundaryType::slip));
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"2*t", "0"});
    p.boundaries["xmax"] =
        given ? boundary(BoundaryType::inlet, {"2*t", "0"}) : boundary(BoundaryType::outlet);
    FluidCase<2> c(MPI_COMM_WORLD, box(8), p);
    for (int i = 0; i < 40; ++i) c.step(0.025);
    const EnergySums& ledger = c.state().ledger;
    EXPECT_NEAR(ledger.energy, 0.5 * 1.3 * 4, 1e-6);
    EXPECT_NEAR(ledger.work, ledger.energy, 0.02 * ledger.energy) << given;
  }
}

/// What is left falls with the square of the tolerance, which at 1e-6 allows 9e-9 J where the density is 1.
TEST(EnergyGuard, what_a_pressure_solve_leaves_in_a_fluid_at_rest_is_no_blow_up) {
  for (const auto& [tolerance, density, left] : {std::array{1e-6, 1.0, 1e-10},
                                                 {1e-6, 1e3, 1e-10},
                                                 {1e-6, 1e5, 1e-10},
                                                 {1e-8, 1.0, 1e-12},
                                                 {1e-8, 1e3, 1e-12},
                                                 {1e-8, 1e5, 1e-12}}) {
    FluidParameters p = layers();
    p.initial_velocity = FluidParameters().initial_velocity;
    p.density = density;
    p.viscosity = 1;
    p.viscous = ViscousTreatment::automatic;
    p.pressure_tolerance = tolerance;
    p.boundaries["xmin"] = boundary(BoundaryType::outlet, {}, "3000");
    FluidCase<2> c(MPI_COMM_WORLD, box(9), p);
    for (int i = 0; i < 5; ++i) c.step(5e-3);
    EXPECT_LT(c.state().ledger.energy, left * density);
  }
}

/// What brings energy: a lid, an inlet, a pressure, a force, a wall that moves the mesh, from rest and at
/// once.
class Driven : public ::testing::TestWithParam<ViscousTreatment> {};

double excess(const FluidParameters& p, double end, int steps, PointMotion motion = {},
              WallVelocity wall = {}) {
  FluidCase<2> c(MPI_COMM_WORLD, box(16), p, std::move(motion));
  double largest = 0;
  for (int i = 0; i < steps; ++i) {
    c.step(end / steps, wall);
    largest = std::max(largest, c.state().ledger.excess / c.state().ledger.energy);
  }
  return largest;
}

TEST_P(Driven, stays_below_a_third_of_what_is_called_a_blow_up) {
  for (const double viscosity : {1e-3, 0.1, 10.0}) {
    FluidParameters p = fluid_of(1.3, viscosity);
    p.viscous = GetParam();
    all_sides(p, 2, boundary(BoundaryType::no_slip));
    FluidParameters lid = p, duct = p, pushed = p, force = p;
    lid.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1+sin(20*t)", "0"});
    duct.boundaries["xmin"] = boundary(BoundaryType::inlet, {"4*y*(1-y)*(1+0.9*sin(9*t))", "0"});
    duct.boundaries["xmax"] = boundary(BoundaryType::outlet);
    pushed.boundaries["xmin"] = boundary(BoundaryType::outlet, {}, "1e5+5*sin(7*t)");
    pushed.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "1e5");
    force.body_force = {{"sin(9*t)*y"}, {"0"}};
    const int steps = viscosity > 1 && GetParam() == ViscousTreatment::explicit_ ? 4 : 40;
    for (const auto& [name, q] :
         {std::pair{"lid", &lid}, {"duct", &duct}, {"pressure", &pushed}, {"force", &force}})
      EXPECT_LT(excess(*q, 0.025 * steps, steps), 0.15) << name << ", viscosity " << viscosity;
  }
}
INSTANTIATE_TEST_SUITE_P(viscous, Driven,
                         ::testing::Values(ViscousTreatment::explicit_, ViscousTreatment::implicit),
                         [](const auto& info) {
                           return info.param == ViscousTreatment::explicit_ ? "explicit" : "implicit";
                         });

}  // namespace couplet::fluid::test::energy_growth_test
