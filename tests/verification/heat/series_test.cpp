// SPDX-License-Identifier: Apache-2.0
// Transient conduction against series: slabs and a sphere.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/heat/support.hpp"

namespace couplet::testing::series_test {
using namespace mesh;
namespace {

// A half space at 0 whose face is put to 1: T = erfc(x / (2 sqrt(a t))), a = 1; 4 sqrt(a t) deep.
double half_space_error(int n) {
  HeatParameters p;
  p.initial_temperature = {"0"};
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "1");
  const double end = 0.01;
  HeatCase scene(make_box(BoxCells::quadrilaterals, {n, 1, 1}, Vec3::Zero(), Vec3(1, 0.1, 0)),
                 {{1, 1.0, 1.0}}, p);
  const int n_steps = 2 * n;
  for (int i = 0; i < n_steps; ++i) scene.step(end / n_steps);
  return scene.error([&](const Vec3& x) { return std::erfc(x[0] / (2 * std::sqrt(end))); });
}

TEST(Slab, heated_suddenly_follows_the_error_function) {
  const double coarse = half_space_error(50), fine = half_space_error(100);
  fmt::print("half space: {:.3e} {:.3e}\n", coarse, fine);
  RecordProperty("error", fmt::format("{:.3e}", fine));
  EXPECT_LT(fine, 4e-4);
  EXPECT_LT(fine, 0.6 * coarse);
}

// A slab |x| < 1 at 1, convection Bi = 1 on its faces: sum C_n exp(-z_n^2 Fo) cos(z_n x), z tan z = Bi,
// C = 4 sin z / (2 z + sin 2 z). Half of it, with a symmetry plane.
double slab_series(double x, double fo) {
  double value = 0;
  for (int n = 0; n < 40; ++n) {
    double low = n * M_PI, high = n * M_PI + M_PI / 2 - 1e-12;
    for (int i = 0; i < 200; ++i) {
      const double z = 0.5 * (low + high);
      (z * std::tan(z) < 1 ? low : high) = z;
    }
    value +=
        4 * std::sin(low) / (2 * low + std::sin(2 * low)) * std::exp(-low * low * fo) * std::cos(low * x);
  }
  return value;
}

double slab_error(int n, HeatScheme scheme) {
  HeatParameters p;
  p.scheme = scheme;
  p.initial_temperature = {"1"};
  p.boundaries["xmin"].type = HeatType::symmetry;
  p.boundaries["xmax"] = convection("1", "0");
  HeatCase scene(make_box(BoxCells::quadrilaterals, {n, 1, 1}, Vec3::Zero(), Vec3(1, 0.1, 0)),
                 {{1, 1.0, 1.0}}, p);
  for (int i = 0; i < 2 * n; ++i) scene.step(0.5 / (2 * n));
  return scene.error([](const Vec3& x) { return slab_series(x[0], 0.5); });
}

TEST(Slab, cooled_by_convection_follows_its_series_in_second_order) {
  for (const HeatScheme scheme : {HeatScheme::three_point, HeatScheme::trapezoidal}) {
    const double coarse = slab_error(20, scheme), fine = slab_error(40, scheme);
    const double slope = std::log2(coarse / fine);
    fmt::print("slab, scheme {}: {:.3e} {:.3e}, slope {:.2f}\n", int(scheme), coarse, fine, slope);
    RecordProperty(fmt::format("slope_{}", int(scheme)), fmt::format("{:.4f}", slope));
    RecordProperty(fmt::format("error_{}", int(scheme)), fmt::format("{:.3e}", fine));
    EXPECT_LT(fine, 1e-4);
    EXPECT_GE(slope, 1.8);
  }
}

/// An octant of the unit ball: a cube whose points are pulled so that its far sides become the sphere.
RawMesh ball_octant(int n) {
  RawMesh raw = make_box(BoxCells::hexahedra, {n, n, n}, Vec3::Zero(), Vec3(1, 1, 1));
  for (Vec3& p : raw.points) {
    const Vec3 q = p.cwiseProduct(p);
    for (int i = 0; i < 3; ++i) {
      const double a = q[(i + 1) % 3], b = q[(i + 2) % 3];
      p[i] *= std::sqrt(1 - a / 2 - b / 2 + a * b / 3);
    }
  }
  return raw;
}

/// sum C_n exp(-z^2 Fo) sin(z r) / (z r), 1 - z cot z = Bi = 1 (z_1 = pi / 2), C = 4 (sin z - z cos z) /
/// (2 z - sin 2 z).
double sphere_series(double r, double fo) {
  double value = 0;
  for (int n = 0; n < 40; ++n) {
    const double z = (n + 0.5) * M_PI;
    const double c = 4 * (std::sin(z) - z * std::cos(z)) / (2 * z - std::sin(2 * z));
    value += c * std::exp(-z * z * fo) * (r * z < 1e-8 ? 1 : std::sin(z * r) / (z * r));
  }
  return value;
}

/// A thin cone of the ball, one cell wide, with four flat sides; its tip is cut off at r = 0.01.
RawMesh ball_cone(int n) {
  RawMesh raw = make_box(BoxCells::hexahedra, {n, 1, 1}, Vec3(0.01, -0.002, -0.002), Vec3(1, 0.002, 0.002));
  for (Vec3& p : raw.points) p = p[0] * Vec3(1, p[1], p[2]).normalized();
  return raw;
}

double sphere_error(const RawMesh& raw, const std::vector<const char*>& surface, int n_steps) {
  HeatParameters p;
  p.initial_temperature = {"1"};
  for (const std::string& name : box_patches(3)) p.boundaries[name].type = HeatType::symmetry;
  for (const char* name : surface) p.boundaries[name] = convection("1", "0");
  HeatCase scene(raw, {{1, 1.0, 1.0}}, p);
  for (int i = 0; i < n_steps; ++i) scene.step(0.2 / n_steps);
  return scene.error([](const Vec3& x) { return sphere_series(x.norm(), 0.2); });
}

TEST(Sphere, cooled_by_convection_follows_its_series_in_second_order) {
  const double coarse = sphere_error(ball_cone(10), {"xmax"}, 20);
  const double fine = sphere_error(ball_cone(20), {"xmax"}, 40);
  const double slope = std::log2(coarse / fine);
  fmt::print("sphere, cone: {:.3e} {:.3e}, slope {:.2f}\n", coarse, fine, slope);
  RecordProperty("slope", fmt::format("{:.4f}", slope));
  RecordProperty("error", fmt::format("{:.3e}", fine));
  EXPECT_LT(fine, 1e-3);
  EXPECT_GE(slope, 1.9);
}

// Along the edges of the cube the cells of this mesh have two faces in one plane: less than second order.
TEST(Sphere, whole_octant_with_flat_cells_at_its_surface_converges_too) {
  const double coarse = sphere_error(ball_octant(5), {"xmax", "ymax", "zmax"}, 20);
  const double fine = sphere_error(ball_octant(10), {"xmax", "ymax", "zmax"}, 40);
  fmt::print("sphere, octant: {:.3e} {:.3e}\n", coarse, fine);
  RecordProperty("error", fmt::format("{:.3e}", fine));
  EXPECT_LT(fine, 2e-3);
  EXPECT_LT(fine, 0.5 * coarse);
}

}  // namespace
}  // namespace couplet::testing::series_test
