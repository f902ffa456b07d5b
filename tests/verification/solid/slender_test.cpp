// SPDX-License-Identifier: Apache-2.0
// Slender bodies at large strain, which bend far under loads that are small beside their stiffness.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/verification/solid/support.hpp"

namespace couplet::testing::slender_test {
namespace {

/// 1 m long, two quadrilaterals across, E = 1 GPa, nu = 0.
SolidParameters plane_bar() {
  SolidParameters p = box_parameters(2);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, 1e9, 0};
  p.material.law = "neo-hookean";
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  return p;
}

/// Largest displacement upwards of any point at 1 s.
double deflection(const SolidParameters& p, double height, int along, int steps = 1) {
  const auto solid = make_solid(
      mesh::make_box(mesh::BoxCells::quadrilaterals, {along, 2, 1}, Vec3::Zero(), Vec3(1, height, 0)), p);
  for (int i = 0; i < steps; ++i) step(*solid, 1. / steps);
  const std::vector<double> u = solid->fields().point_displacement();
  double most = 0;
  for (std::size_t v = 0; v < u.size() / 2; ++v) most = std::max(most, u[2 * v + 1]);
  return most;
}

// Conjugate gradients ended beyond where they had begun: no step however small was solved. q L^4 / (8 E I), an eighth less stiff.
TEST(Slender, a_pressure_that_follows_bends_a_bar_100_to_1) {
  SolidParameters p = plane_bar();
  p.boundaries["ymin"] = boundary(Type::pressure);
  p.boundaries["ymin"].pressure = {"0.1*t"};
  const double small = 0.1 / (8 * 1e9 * 1e-6 / 12);
  EXPECT_NEAR(deflection(p, 0.01, 60), small / 1.125, 0.02 * small);
}

// Forces have no more digits than the displacements that they follow from: equilibrium to 1e-10 of the load is beyond them.
TEST(Slender, equilibrium_is_as_near_as_the_numbers_are) {
  SolidParameters p = plane_bar();
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "83.3*t"});
  EXPECT_NEAR(deflection(p, 0.002, 250, 15), 0.0833 / 1.125, 0.002);  // F L^3 / (3 E I), an eighth too stiff
}

/// What a static run says of a bar that is carried `far` metres and then sheared by `pull` at its end.
std::string said(double far, double pull) {
  SolidParameters p = plane_bar();
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {fmt::format("{}*min(2*t, 1)", far), "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", fmt::format("{}*max(2*t - 1, 0)", pull)});
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  deflection(p, 0.1, 20, 2);
  return ::testing::internal::GetCapturedStdout() + ::testing::internal::GetCapturedStderr();
}

// Equilibrium within rounding says nothing of a load that is smaller.
TEST(Slender, a_load_below_rounding_is_said_to_be_lost) {
  constexpr const char* lost = "is not resolved";
  EXPECT_NE(said(1000, 1e-6).find(lost), std::string::npos);
  EXPECT_EQ(said(0, 1e-2).find(lost), std::string::npos);
  EXPECT_EQ(said(1000, 1e3).find(lost), std::string::npos);
  EXPECT_EQ(said(1000, 0).find(lost), std::string::npos);  // no load
}

/// Name of the method of a beam 40:1 of n cubes along.
std::string method_of(int along) {
  SolidParameters p = box_parameters(3);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0", "0"});
  return make_solid(mesh::make_box(mesh::BoxCells::hexahedra, {along, 2, 2}, Vec3::Zero(), Vec3(40, 1, 1)), p)
      ->body()
      .equilibrium()
      .name({});
}

// A thousand cells took over four times as long with factors as without.
TEST(Slender, factors_in_space_are_for_few_cells) {
  EXPECT_NE(method_of(40).find("factors"), std::string::npos);
  EXPECT_EQ(method_of(160).find("factors"), std::string::npos);
}

}  // namespace
}  // namespace couplet::testing::slender_test
