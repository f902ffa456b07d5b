// SPDX-License-Identifier: Apache-2.0
// Rigid bodies in a mesh that does not know them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.hpp"
#include "fluid_case.hpp"

namespace couplet::fluid::test::immersed_test {
using namespace mesh;
namespace {

FluidParameters channel_with(const std::string& level, std::vector<std::string> velocity = {}) {
  FluidParameters p;
  p.density = 1;
  p.viscosity = 1e-3;
  p.pressure_tolerance = 1e-6;
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"1.2*y*(0.41-y)/0.41^2", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.bodies["body"].level.text = level;
  for (const std::string& text : velocity) p.bodies["body"].velocity.push_back({text});
  return p;
}

/// Schaefer and Turek's 2D-1 (cd = 5.5795 with a body-fitted mesh), 20 cells across the cylinder.
TEST(ImmersedCylinder, has_the_drag_of_the_body_fitted_one_within_five_percent_and_does_not_leak) {
  const FluidParameters p = channel_with("sqrt((x-0.2)^2+(y-0.2)^2)-0.05");
  FluidCase<2> c(MPI_COMM_WORLD,
                 make_box(BoxCells::quadrilaterals, {200, 82, 1}, Vec3::Zero(), Vec3(1, 0.41, 1)), p);
  c.run(3.5, 35);
  const State<2>& s = c.state();
  const auto [pressure, friction] =
      c.fluid().bodies()->forces(*s.placement, *s.pressure[0], s.u, p.viscosity).front();
  const double drag = 500 * (pressure[0] + friction[0]), leak = c.fluid().bodies()->leak(*s.placement, s.phi);
  const double inflow = 0.2 * 0.41;
  printf("immersed cylinder: cd %.4f (pressure %.4f), lift %.4f, leak %.1e of the inflow\n", drag,
         500 * pressure[0], 500 * (pressure[1] + friction[1]), leak / inflow);
  RecordProperty("drag_coefficient", std::to_string(drag));
  RecordProperty("leak", std::to_string(leak / inflow * 1e9) + "e-9");
  EXPECT_NEAR(drag, 5.5795, 0.05 * 5.5795);
  EXPECT_LT(leak, 0.005 * inflow);
}

/// A gate closes the channel from below and opens again: cells turn from fluid to body and back.
TEST(ImmersedGate, closes_and_opens_the_channel) {
  FluidParameters p = channel_with("max(abs(x-0.3)-0.04, y-0.2*(1-cos(6.2831853*t))-0.005)",
                                   {"0", "0.2*6.2831853*sin(6.2831853*t)"});
  p.boundaries["xmin"] = boundary(BoundaryType::outlet, {}, "0.05");
  FluidCase<2> c(MPI_COMM_WORLD,
                 make_box(BoxCells::quadrilaterals, {60, 41, 1}, Vec3::Zero(), Vec3(0.6, 0.41, 1)), p);
  const auto flow = [&] {
    const Patch& out = *c.mesh().find_patch("xmax");
    double sum_of = 0;
    for (Index f = out.first; f < out.first + out.count; ++f) sum_of += c.state().phi[f];
    return parallel::sum(c.mesh().comm, sum_of);
  };
  const auto solids = [&] {
    GlobalIndex n = 0;
    for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) n += c.fluid().bodies()->is_solid(i);
    return parallel::sum(c.mesh().comm, n);
  };
  c.run(0.1, 10);
  const GlobalIndex open = solids();
  c.run(0.5, 40);
  EXPECT_GT(solids(), 4 * open);
  EXPECT_LT(std::abs(flow()), 2e-3);  // the gap is nearly shut
  c.run(1.3, 80);
  EXPECT_GT(flow(), 1e-2);
  double largest = 0;
  for (const Vec<2>& u : c.state().u) largest = std::max(largest, u.norm());
  EXPECT_LT(parallel::max(MPI_COMM_WORLD, largest), 3);
}

/// A step that reaches through the outlet, and a body across a part of the inlet: what enters beside the one leaves beside
/// the other, and nothing through the faces of their cells.
TEST(ImmersedBody, closes_the_faces_of_inlets_and_outlets_within_it) {
  FluidParameters p = channel_with("min(max(0.31-x, y-0.1), max(x-0.05, 0.35-y))");
  p.pressure_tolerance = 1e-12;
  FluidCase<2> c(MPI_COMM_WORLD,
                 make_box(BoxCells::quadrilaterals, {60, 41, 1}, Vec3::Zero(), Vec3(0.6, 0.41, 1)), p);
  double inflow = 0, outflow = 0, within = 0;
  const auto sum_up = [&] {
    inflow = outflow = within = 0;
    for (Index f = c.mesh().n_interior; f < c.mesh().n_flux_faces(); ++f) {
      const double phi = c.state().phi[f];
      (phi < 0 ? inflow : outflow) += std::abs(phi);
      if (c.fluid().bodies()->is_solid(c.mesh().owner[f])) within += std::abs(phi);
    }
    for (double* value : {&inflow, &outflow, &within}) *value = parallel::sum(c.mesh().comm, *value);
  };
  sum_up();  // of the start
  EXPECT_EQ(within, 0);
  c.run(0.2, 40);
  sum_up();
  RecordProperty("through_closed_faces", std::to_string(within / inflow));
  EXPECT_GT(inflow, 0.05);
  EXPECT_EQ(within, 0) << within / inflow;
  EXPECT_LT(std::abs(outflow - inflow), 1e-12 * inflow) << outflow / inflow - 1;
}

/// A square of 4 x 4 cells under p = x and in a uniform flow that stops at it: a pressure at the middles of the cells beside
/// it, and mu du/h on each of the 16 faces.
TEST(ImmersedBody, has_the_load_of_a_linear_pressure_and_of_the_shear_beside_it) {
  const FluidParameters p = channel_with("max(abs(x-0.5), abs(y-0.5))-0.21");
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {10, 10, 1}, Vec3::Zero(), Vec3::Ones()),
                 p);
  c.step(1e-4);
  const ImmersedBodies<2>& bodies = *c.fluid().bodies();
  const Placement<2>& at = *c.state().placement;
  PressureLevel<2> level;
  Vectors<2> u;
  for (Index i = 0; i < c.mesh().cells.n_local(); ++i) {
    level.p.push_back(at.centre[i].x());
    u.push_back(bodies.is_solid(i) ? Vec<2>(0, 0) : Vec<2>(1, 0));
  }
  const auto [pushed, rubbed] = bodies.forces(at, level, u, 1e-3).front();
  EXPECT_LT((pushed - Vec<2>(0.4 * (0.25 - 0.75), 0)).norm(), 1e-12);
  EXPECT_LT((rubbed - Vec<2>(16 * 1e-3, 0)).norm(), 1e-12);
}

TEST(ImmersedBody, without_an_outlet_is_refused) {
  FluidParameters p = channel_with("y-0.1");
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::no_slip);
  EXPECT_THAT([&] { FluidCase<2>(MPI_COMM_SELF, channel_mesh(), p); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("needs an outlet")));
}

}  // namespace
}  // namespace couplet::fluid::test::immersed_test
