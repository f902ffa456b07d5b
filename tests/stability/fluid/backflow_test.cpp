// SPDX-License-Identifier: Apache-2.0
// Fluid is sucked in and pushed out through two openings by the pressure at one of them, 200 sin(6 t) Pa. Mechanism: what comes in
// through an outlet brings kinetic energy of its own that nobody pays for. With it left out (the outlet's stabilisation) what
// comes in from rest has what the pressure gives it, rho u^2/2 <= dp [Bernoulli]: 17.5 m/s, a quarter more in a single cell.
#include <gtest/gtest.h>

#include <cmath>

#include "../../verification/fluid/fluid_case.hpp"
#include "common/base/error.hpp"

namespace couplet::fluid::test::backflow_test {
namespace {

double largest_speed(bool stabilised) {
  FluidParameters p;
  p.density = 1.3;
  p.viscosity = 1e-3;
  p.pressure_tolerance = 1e-7;
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

}  // namespace
}  // namespace couplet::fluid::test::backflow_test
