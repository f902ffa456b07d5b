// SPDX-License-Identifier: Apache-2.0
// Vortices of Taylor and Green that become turbulence no mesh here resolves: bounded by the scheme itself, with no
// dissipation added.
#include "../../verification/fluid/fluid_case.hpp"

namespace couplet::fluid::test::under_resolved_test {

/// An eighth of the vortices of a box of 2 pi: its walls are planes of symmetry. Speed and length 1, one turnover in 1 s.
FluidParameters vortices(double reynolds) {
  FluidParameters p = fluid_of(1, 1 / reynolds);
  p.initial_velocity = {{"sin(x)*cos(y)*cos(z)"}, {"-cos(x)*sin(y)*cos(z)"}, {"0"}};
  all_sides(p, 3, boundary(BoundaryType::slip));
  return p;
}

mesh::RawMesh eighth(int n) {
  return mesh::make_box(mesh::BoxCells::hexahedra, {n, n, n}, Vec3::Zero(), Vec3::Constant(M_PI));
}

double kinetic_energy(const FluidCase<3>& c) {
  double sum = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    sum += 0.5 * c.state().placement->volume[i] * c.state().u[i].squaredNorm();
  return couplet::parallel::sum(c.mesh().comm, sum);
}

// Mechanism: convection that does work on its own moves energy to the smallest scales and piles it up there.
TEST(UnderResolved, vortices_never_gain_energy_in_twenty_turnovers_at_any_reynolds_number) {
  for (const double reynolds : {1e2, 1e4, 1e6}) {
    FluidCase<3> c(MPI_COMM_WORLD, eighth(8), vortices(reynolds));
    const double first = kinetic_energy(c);
    double before = first, gain = 0;
    for (int i = 0; i < 80; ++i) {
      c.step(0.25);
      const double now = kinetic_energy(c);
      gain = std::max(gain, now / before - 1);
      before = now;
    }
    RecordProperty(fmt::format("left_at_1e{:.0f}", std::log10(reynolds)),
                   fmt::format("{:.3g}", before / first));
    EXPECT_LT(gain, 1e-3) << reynolds;
    EXPECT_LT(before, first) << reynolds;
    if (reynolds > 1e5) {
      EXPECT_GT(before, 0.01 * first) << "dissipation was added";
    }
  }
}

// The neighbour: the same flow with steps that cross two cells.
TEST(UnderResolved, vortices_with_steps_beyond_the_limit_are_refused_by_name) {
  FluidParameters p = vortices(1e6);
  p.time_step = 1.0;
  FluidCase<3> c(MPI_COMM_WORLD, eighth(8), p);
  std::string said;
  try {
    for (int i = 0; i < 20; ++i) c.step(1);
  } catch (const SolveFailure& failure) {
    said = failure.what();
  }
  EXPECT_THAT(said, testing::HasSubstr("The flow diverges")) << kinetic_energy(c);
}

// Fluid is sucked in and pushed out through two openings by the pressure at one of them, 200 sin(6 t) Pa. Mechanism: what comes in
// through an outlet brings kinetic energy of its own that nobody pays for. With it left out (the outlet's stabilisation) what
// comes in from rest has what the pressure gives it, rho u^2/2 <= dp [Bernoulli]: 17.5 m/s, a quarter more in a single cell.

double largest_speed(bool stabilised) {
  FluidParameters p = fluid_of(1.3, 1e-3, 1e-7);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmin"] = boundary(BoundaryType::outlet, {}, "200*sin(6*t)");
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["xmin"].backflow_stabilisation = p.boundaries["xmax"].backflow_stabilisation = stabilised;
  FluidCase<2> c(MPI_COMM_WORLD,
                 mesh::make_box(mesh::BoxCells::quadrilaterals, {12, 24, 1}, Vec3::Zero(), Vec3(0.5, 1, 1)),
                 p);
  double largest = 0;
  for (int i = 0; i < 150; ++i) {
    c.step(0.01);
    for (const Vec<2>& u : c.state().u) largest = std::max(largest, u.norm());
  }
  return parallel::max(MPI_COMM_WORLD, largest);
}

const double bound = 1.25 * std::sqrt(2 * 200 / 1.3);

TEST(Backflow, stays_bounded_by_the_work_of_the_pressure) { EXPECT_LT(largest_speed(true), bound); }
TEST(Backflow, goes_beyond_it_without_the_stabilisation) { EXPECT_GT(largest_speed(false), 2 * bound); }

}  // namespace couplet::fluid::test::under_resolved_test
