// SPDX-License-Identifier: Apache-2.0
// Constant curvature, rigid motions and mass on distorted meshes.
#include <gtest/gtest.h>

#include "common/linalg/linear_solver.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::patch_test {
using namespace mesh;
namespace {

using namespace test;

struct Case {
  const char* name;
  RawMesh raw;
};

std::vector<Case> meshes() {
  return {{"triangles", square(6, BoxCells::triangles, 0.3)},
          {"quadrilaterals", square(6, BoxCells::quadrilaterals, 0.2)},
          {"disc", disc(5)}};
}

/// w, w,x, w,y of a quadratic at every point.
std::vector<double> quadratic(const PlateModel& plate, const std::array<double, 6>& c) {
  std::vector<double> points;
  for (const Vec2& p : plate.surface().points) {
    const double x = p.x(), y = p.y();
    points.push_back(c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y);
    points.push_back(c[1] + 2 * c[3] * x + c[4] * y);
    points.push_back(c[2] + c[4] * x + 2 * c[5] * y);
  }
  return points;
}

TEST(PlatePatch, constant_curvature_leaves_no_force_inside) {
  double worst = 0;
  for (const Case& mesh : meshes()) {
    const PlateModel plate = make_plate(mesh.raw, {});
    const std::vector<double> u = quadratic(plate, {0.1, 0.2, -0.3, 0.7, -0.4, 0.9});
    std::vector<double> force(u.size());
    plate.stiffness().multiply(u, force);
    std::vector<bool> inside(plate.surface().points.size(), true);
    for (const auto& edge : plate.surface().edges) inside[edge.from] = inside[edge.to] = false;
    double largest = 0, left = 0;
    for (std::size_t p = 0; p < inside.size(); ++p)
      for (int c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs(force[3 * p + c]));
        if (inside[p]) left = std::max(left, std::abs(force[3 * p + c]));
      }
    EXPECT_LT(left, 1e-10 * largest) << mesh.name;
    EXPECT_GT(largest, 0.1) << mesh.name;
    worst = std::max(worst, left / largest);
  }
  RecordProperty("worst", fmt::format("{:.3e}", worst));
}

TEST(PlatePatch, constant_curvature_is_what_its_boundary_values_give) {
  double worst = 0;
  for (const Case& mesh : meshes()) {
    // Clamped all around: prescribe the boundary, solve for the inside.
    const PlateModel free = make_plate(mesh.raw, {}),
                     held = make_plate(mesh.raw, all_edges(Support::clamped));
    const std::vector<double> exact = quadratic(free, {0, 0.1, 0.2, 0.5, 0.3, -0.8});
    std::vector<double> boundary = exact, force(exact.size());
    for (std::size_t r = 0; r < exact.size(); ++r)
      if (!held.is_supported(r)) boundary[r] = 0;
    free.stiffness().multiply(boundary, force);
    for (std::size_t r = 0; r < force.size(); ++r) force[r] = held.is_supported(r) ? 0 : -force[r];
    const std::vector<double> u = held.deflect(force);
    double apart = 0;
    for (std::size_t r = 0; r < u.size(); ++r)
      if (!held.is_supported(r)) apart = std::max(apart, std::abs(u[r] - exact[r]));
    EXPECT_LT(apart, 1e-10) << mesh.name;
    worst = std::max(worst, apart);
  }
  RecordProperty("worst", fmt::format("{:.3e}", worst));
}

TEST(PlatePatch, energy_of_constant_curvature_is_exact) {
  for (const Case& mesh : meshes()) {
    const PlateModel plate = make_plate(mesh.raw, {});
    const std::vector<double> u = quadratic(plate, {0, 0, 0, 0.5, 0.25, 1});
    std::vector<double> force(u.size());
    plate.stiffness().multiply(u, force);
    double twice = 0, area = 0;
    for (std::size_t r = 0; r < u.size(); ++r) twice += u[r] * force[r];
    for (const double a : plate.cell_areas()) area += a;
    // D ((wxx + wyy)^2 - 2 (1 - nu) (wxx wyy - wxy^2)), wxx = 1, wyy = 2, wxy = 1/4
    EXPECT_NEAR(twice, area * (9 - 2 * 0.7 * (2 - 0.0625)), 1e-9) << mesh.name;
  }
}

TEST(PlatePatch, mass_of_a_quadratic_deflection_is_exact_on_the_square) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::quadrilaterals}) {
    const PlateModel plate = make_plate(square(5, cells, 0.2), {});
    const std::vector<double> w = quadratic(plate, {1, 2, -1, 0.5, 0, 0});
    std::vector<double> m(w.size());
    plate.mass().multiply(w, m);
    double energy = 0;
    for (std::size_t r = 0; r < w.size(); ++r) energy += w[r] * m[r];
    // int_0^1 int_0^1 (1 + 2 x - y + x^2 / 2)^2 dx dy
    const double a0 = 1 + 1 + 1. / 6,
                 a2 = 1 + 4. / 3 + 1. / 20 + 2 + 1. / 3 + 0.5;  // of f(x) = 1 + 2x + x^2/2
    EXPECT_NEAR(energy, a2 - 2 * a0 * 0.5 + 1. / 3, 1e-12);
    const std::vector<double> means = plate.cell_means(w), areas = plate.cell_areas();
    double integral = 0;
    for (std::size_t c = 0; c < means.size(); ++c) integral += means[c] * areas[c];
    EXPECT_NEAR(integral, a0 - 0.5, 1e-13);
  }
}

TEST(PlatePatch, a_support_holds_what_it_says) {
  const PlateModel plate = make_plate(
      square(4),
      {{"xmin", Support::clamped}, {"xmax", Support::simply_supported}, {"ymin", Support::symmetry}});
  for (std::size_t p = 0; p < plate.surface().points.size(); ++p) {
    std::vector<double> one(plate.n_unknowns(), 0);
    const Vec2& x = plate.surface().points[p];
    const auto is_held = [&](int component) {  // nothing that is not held can be reached
      std::vector<double> direction(plate.n_unknowns(), 0);
      direction[3 * p + component] = 1;
      direction = plate.to_unknowns(direction);
      double free = 0;
      for (int c = 0; c < 3; ++c)
        if (!plate.is_supported(3 * p + c)) free += std::abs(direction[3 * p + c]);
      return free < 1e-12;
    };
    const bool clamped = x.x() == 0, hinged = x.x() == 1, mirror = x.y() == 0;
    EXPECT_EQ(is_held(0), clamped || hinged) << x.transpose();
    EXPECT_EQ(is_held(1), clamped) << x.transpose();
    EXPECT_EQ(is_held(2), clamped || hinged || mirror) << x.transpose();
  }
}

}  // namespace
}  // namespace couplet::plate::patch_test
