// SPDX-License-Identifier: Apache-2.0
// Linear shear on a moving mesh, and the force on an oscillating body seen from two frames.
#include <gtest/gtest.h>

#include <numbers>

#include "fluid_case.hpp"

namespace couplet::fluid::test::moving_test {
using namespace mesh;
namespace {

// Inner points swing about their places, each part of the box in its own phase.
Vec3 swing(const Vec3& x, GlobalIndex, double t) {
  const double shape = std::sin(std::numbers::pi * x.x()) * std::sin(std::numbers::pi * x.y());
  return x + 0.05 * shape *
                 Vec3(std::sin(9 * t + 4 * x.y()) - std::sin(4 * x.y()),
                      std::cos(7 * t + 3 * x.x()) - std::cos(3 * x.x()), 0);
}

double shear_error(int n, ViscousTreatment viscous) {
  FluidParameters p;
  p.density = 1.3;
  p.viscosity = 0.02;
  p.viscous = viscous;
  p.pressure_tolerance = 1e-10;
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
  FluidParameters p;
  p.density = rho;
  p.viscosity = 0.02;
  p.pressure_tolerance = 1e-8;
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

}  // namespace
}  // namespace couplet::fluid::test::moving_test
