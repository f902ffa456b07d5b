// SPDX-License-Identifier: Apache-2.0
// Walls along which the fluid slides with a slip length, between those without slip and those without friction.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fluid_case.hpp"

namespace couplet::fluid::test::partial_slip_test {
namespace {

constexpr double length = 0.3, lid = 2, force = 0.8;

BoundaryParameters sliding(double slip_length) {
  BoundaryParameters b = boundary(BoundaryType::partial_slip);
  b.slip_length = slip_length;
  return b;
}

FluidParameters channel_between(const BoundaryParameters& floor, const BoundaryParameters& ceiling,
                                ViscousTreatment viscous) {
  FluidParameters p;
  p.density = 1.3;
  p.viscosity = 0.5;
  p.viscous = viscous;
  p.pressure_tolerance = 1e-12;
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::periodic);
  p.boundaries["ymin"] = floor;
  p.boundaries["ymax"] = ceiling;
  return p;
}

/// n x n cells of the unit square, x by `tilt` of y, then turned by `angle` about the origin.
mesh::RawMesh square(int n, double tilt = 0, double angle = 0) {
  mesh::RawMesh raw = mesh::make_box(mesh::BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 1));
  for (Vec3& x : raw.points) {
    const double a = x.x() + tilt * x.y(), b = x.y();
    x = Vec3(std::cos(angle) * a - std::sin(angle) * b, std::sin(angle) * a + std::cos(angle) * b, 0);
  }
  raw.periodic = {{"xmin", "xmax"}};
  return raw;
}

/// A lid drags the fluid over the floor, in a square turned by `angle`: u = lid (y + L)/(1 + L) along the walls.
double error_of_drag(const BoundaryParameters& floor, ViscousTreatment viscous, double angle, double& shear,
                     double tilt = 0) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto along = [](double factor, double slope) { return fmt::format("{:.17g}", factor * slope); };
  FluidParameters p =
      channel_between(floor, boundary(BoundaryType::moving_wall, {along(lid, c), along(lid, s)}), viscous);
  FluidCase<2> flow(MPI_COMM_WORLD, square(8, tilt, angle), p);
  flow.run(12, 300);
  const mesh::Patch& patch = *flow.mesh().find_patch("ymin");
  shear = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    shear += flow.fluid().viscous_force()[f - flow.mesh().n_interior].dot(Vec<2>(c, s));
  shear = parallel::sum(MPI_COMM_WORLD, shear);
  return flow.largest_velocity_error([&](const Vec3& x) {
    const double height = c * x.y() - s * x.x();
    return Vec3(lid * (height + length) / (1 + length) * Vec3(c, s, 0));
  });
}

TEST(PartialSlip, lets_a_lid_drag_the_fluid_as_far_as_the_slip_length_says_in_any_direction) {
  for (const auto viscous : {ViscousTreatment::explicit_, ViscousTreatment::implicit})
    for (const double angle : {0.0, 0.5}) {
      double shear = 0;
      EXPECT_LT(error_of_drag(sliding(length), viscous, angle, shear), 1e-6);
      EXPECT_NEAR(shear, 0.5 * lid / (1 + length), 1e-6);
      EXPECT_GT(error_of_drag(boundary(BoundaryType::no_slip), viscous, angle, shear), 0.1);
      EXPECT_GT(error_of_drag(sliding(2 * length), viscous, angle, shear), 0.1);
    }
}

TEST(PartialSlip, is_exact_for_linear_flow_on_sheared_cells) {
  double shear = 0;
  EXPECT_LT(error_of_drag(sliding(length), ViscousTreatment::implicit, 0, shear, 0.3), 1e-6);
  EXPECT_GT(error_of_drag(sliding(2 * length), ViscousTreatment::implicit, 0, shear, 0.3), 0.1);
}

/// A force drives the fluid between two such walls: u = G/(2 nu) (y (1 - y) + L), of which the cells have G h^2/(8 nu) too
/// much, as without slip.
TEST(PartialSlip, is_of_second_order_in_a_driven_channel) {
  for (const int n : {6, 12}) {
    FluidParameters p = channel_between(sliding(length), sliding(length), ViscousTreatment::implicit);
    p.body_force = {{std::to_string(force)}, {"0"}};
    FluidCase<2> flow(MPI_COMM_WORLD, square(n), p);
    flow.run(30, 300);
    const double half = force / (2 * 0.5 / 1.3), own = half / (4 * n * n);
    const auto exact = [&](const Vec3& x) { return Vec3(half * (x.y() * (1 - x.y()) + length) + own, 0, 0); };
    EXPECT_LT(flow.largest_velocity_error(exact), 1e-6) << n;
  }
}

TEST(PartialSlip, ends_at_walls_without_slip_and_at_walls_without_friction) {
  const auto flow = [](const BoundaryParameters& wall) {
    FluidParameters p = channel();
    p.boundaries["ymin"] = p.boundaries["ymax"] = wall;
    auto c = std::make_unique<FluidCase<2>>(MPI_COMM_WORLD, channel_mesh(), p);
    c->run(0.3, 15);
    return c;
  };
  const auto fixed = flow(boundary(BoundaryType::no_slip)), free = flow(boundary(BoundaryType::slip));
  EXPECT_GT(difference(*fixed, *free), 1e-2);
  EXPECT_LT(difference(*flow(sliding(1e-13)), *fixed), 1e-9);
  EXPECT_LT(difference(*flow(sliding(1e13)), *free), 1e-9);
}

}  // namespace
}  // namespace couplet::fluid::test::partial_slip_test
