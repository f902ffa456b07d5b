// SPDX-License-Identifier: Apache-2.0
// Linear shear on a moving mesh, and the force on an oscillating body seen from two frames.
#include "fluid_case.hpp"
#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid::test::moving_test {
using namespace mesh;

// Inner points swing about their places, each part of the box in its own phase.
Vec3 swing(const Vec3& x, GlobalIndex, double t) {
  const double shape = std::sin(std::numbers::pi * x.x()) * std::sin(std::numbers::pi * x.y());
  return x + 0.05 * shape *
                 Vec3(std::sin(9 * t + 4 * x.y()) - std::sin(4 * x.y()),
                      std::cos(7 * t + 3 * x.x()) - std::cos(3 * x.x()), 0);
}

double shear_error(int n, ViscousTreatment viscous) {
  FluidParameters p = fluid_of(1.3, 0.02, 1e-10);
  p.viscous = viscous;
  p.initial_velocity = {{"2*y-1"}, {"0"}};
  all_sides(p, 2, boundary(BoundaryType::moving_wall, {"2*y-1", "0"}));
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3::Ones()), p,
                 swing);
  c.run(0.5, 2 * n);
  return c.velocity_error([](const Vec3& x) { return Vec3(2 * x.y() - 1, 0, 0); });
}

TEST(LinearShear, is_kept_to_second_order_on_a_moving_mesh) {
  for (const auto viscous : {ViscousTreatment::explicit_, ViscousTreatment::implicit}) {
    const double e[3] = {shear_error(12, viscous), shear_error(24, viscous), shear_error(48, viscous)};
    const double slope = std::log2(e[1] / e[2]);
    printf("linear shear on a moving mesh: %.2e %.2e %.2e slope %.2f\n", e[0], e[1], e[2], slope);
    RecordProperty(viscous == ViscousTreatment::explicit_ ? "slope_explicit" : "slope_implicit",
                   std::to_string(slope));
    EXPECT_GE(slope, 1.9);
  }
}

/// Quadrilaterals between two circles, finer towards the inner one; patches "body" and "far".
RawMesh ring(int around, int layers, double inner, double outer) {
  RawMesh raw;
  raw.dim = 2;
  raw.zones = {"default"};
  raw.patches = {"body", "far"};
  for (int j = 0; j <= layers; ++j) {
    const double r = inner * std::pow(outer / inner, double(j) / layers);
    for (int i = 0; i < around; ++i) {
      const double a = 2 * std::numbers::pi * i / around;
      raw.points.emplace_back(r * std::cos(a), r * std::sin(a), 0);
    }
  }
  const auto at = [&](int i, int j) { return static_cast<Index>(j * around + (i % around)); };
  for (int j = 0; j < layers; ++j)
    for (int i = 0; i < around; ++i) {
      raw.cell_type.push_back(CellType::quadrilateral);
      raw.cell_zone.push_back(0);
      const Index points[4] = {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)};
      raw.cell_points.push_row(points);
    }
  for (int i = 0; i < around; ++i)
    for (const int j : {0, layers}) {
      const Index points[2] = {at(i, j), at(i + 1, j)};
      raw.boundary_points.push_row(points);
      raw.boundary_patch.push_back(j == 0 ? 0 : 1);
    }
  return raw;
}

Vec<2> force_on_body(FluidCase<2>& c) {
  double sums[2] = {};
  const Patch& body = *c.mesh().find_patch("body");
  for (Index f = body.first; f < body.first + body.count; ++f) {
    const Vec<2> force = c.fluid().pressure_force()[f - c.mesh().n_interior] +
                         c.fluid().viscous_force()[f - c.mesh().n_interior];
    sums[0] += force[0];
    sums[1] += force[1];
  }
  return {parallel::sum(c.mesh().comm, sums[0]), parallel::sum(c.mesh().comm, sums[1])};
}

/// A cylinder swings in still fluid, once with its mesh, once at rest in a fluid that swings about it. The
/// second force lacks what the swinging frame does to the displaced fluid, rho A dw/dt.
TEST(OscillatingBody, feels_the_same_force_whether_mesh_or_frame_moves) {
  const double amplitude = 0.2, omega = 2 * std::numbers::pi, rho = 1.2, inner = 0.5, dt = 0.005;
  const int around = 48;
  const auto place = [&](double t) { return Vec3(amplitude * (1 - std::cos(omega * t)), 0, 0); };
  const auto speed = [&](double t) { return Vec3(amplitude * omega * std::sin(omega * t), 0, 0); };
  const RawMesh raw = ring(around, 36, inner, 5);
  FluidParameters p = fluid_of(rho, 0.02, 1e-8);
  p.boundaries["body"] = boundary(BoundaryType::interface);
  p.boundaries["far"] = boundary(BoundaryType::no_slip);
  FluidCase<2> moving(MPI_COMM_WORLD, raw, p,
                      [&](const Vec3& x, GlobalIndex, double t) { return Vec3(x + place(t)); });
  p.boundaries["body"] = boundary(BoundaryType::no_slip);
  p.boundaries["far"] = boundary(BoundaryType::moving_wall, {"-0.2*2*pi*sin(2*pi*t)", "0"});
  FluidCase<2> frame(MPI_COMM_WORLD, raw, p);
  const double area = 0.5 * around * inner * inner * std::sin(2 * std::numbers::pi / around);
  double largest = 0, gap = 0, start = 0;
  for (int i = 0; i < 300; ++i) {
    const double t = i * dt;
    moving.step(dt, [&](const Vec3&, double time) { return speed(time); });
    frame.step(dt);
    const Vec3 inertia = rho * area * (speed(t + dt) - speed(t)) / dt;
    const double a = force_on_body(moving)[0], b = force_on_body(frame)[0] + inertia.x();
    largest = std::max(largest, std::abs(a));
    if (t > 0.25)
      gap = std::max(gap, std::abs(a - b));  // the start from rest is another impulse in each frame
    else
      start = std::max(start, std::abs(a - b));
  }
  printf("oscillating body: largest force %.4f, largest gap %.2e (%.3f %%)\n", largest, gap,
         100 * gap / largest);
  RecordProperty("relative_gap", std::to_string(gap / largest));
  EXPECT_LT(gap, 0.001 * largest);
  EXPECT_GT(largest, 1);
}

// Rigid bodies in a mesh that does not know them.

FluidParameters channel_with(const std::string& level, std::vector<std::string> velocity = {}) {
  FluidParameters p = fluid_of(1, 1e-3, 1e-6);
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

// Pressure and velocity live in the same cells: the mode that alternates from cell to cell must stay out of
// the pressure, and what that takes from the kinetic energy is told by the energy budget.

constexpr int n = 48;

/// Amplitude of the alternating part of p, by its mixed fourth difference (0 for cubic fields, the amplitude
/// itself for +-1 from cell to cell), over the amplitude of p; away from the lid's corners, where p is
/// singular.
double alternating_part(const FluidCase<2>& c) {
  const State<2>& s = c.state();
  std::vector<double> p(n * n);
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    const Vec<2> place = n * s.placement->centre[i];
    p[int(place.y()) * n + int(place.x())] = s.pressure[0]->p[i];
  }
  double alternating = 0, mean = 0, square = 0;
  int count = 0;
  for (int j = n / 8; j < n - n / 8; ++j)
    for (int i = n / 8; i < n - n / 8; ++i) {
      const auto at = [&](int di, int dj) { return p[(j + dj) * n + i + di]; };
      const double part = (4 * at(0, 0) - 2 * (at(1, 0) + at(-1, 0) + at(0, 1) + at(0, -1)) + at(1, 1) +
                           at(1, -1) + at(-1, 1) + at(-1, -1)) /
                          16;
      alternating += part * part;
      mean += at(0, 0);
      square += at(0, 0) * at(0, 0);
      ++count;
    }
  mean /= count;
  return std::sqrt(alternating / count / (square / count - mean * mean));
}

/// Cavity at Re = 1000 to 4 s: the alternating part at the end, and the energy that the pressure took as a
/// share of what viscosity and pressure took.
struct Outcome {
  double alternating = 0, taken = 0;
};
Outcome cavity(double dt) {
  FluidParameters p = fluid_of(1, 1e-3, 1e-8);
  p.viscous = ViscousTreatment::explicit_;
  p.time_step = dt;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  FluidCase<2> c(MPI_COMM_SELF,
                 mesh::make_box(mesh::BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3::Ones()), p);
  double viscous = 0, pressure = 0;
  for (int i = 0; i < std::lround(4 / dt); ++i) {
    c.step(dt);
    const EnergyBudget budget = energy_budget(c.fluid());
    viscous += budget.viscous;
    pressure += budget.pressure;
  }
  return {alternating_part(c), pressure / (pressure + viscous)};
}

TEST(Checkerboard, stays_out_of_the_pressure_whatever_the_step_and_costs_little_energy) {
  const Outcome coarse = cavity(0.01), fine = cavity(0.001);
  printf("checkerboard: alternating %.1e %.1e, energy taken %.1e %.1e\n", coarse.alternating,
         fine.alternating, coarse.taken, fine.taken);
  RecordProperty("alternating", std::to_string(1e9 * std::max(coarse.alternating, fine.alternating)) + "e-9");
  RecordProperty("taken", std::to_string(1e9 * coarse.taken) + "e-9");
  EXPECT_LT(coarse.alternating, 5e-4);
  EXPECT_LT(fine.alternating, 5e-4);
  EXPECT_LT(std::abs(coarse.taken), 0.01);
}

}  // namespace couplet::fluid::test::moving_test
