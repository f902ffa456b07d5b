// SPDX-License-Identifier: Apache-2.0
// A run judges its own answer: the guards fire where it is nonsense and are silent where it is sound.
#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/diagnostics/finding.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::audit_test {
using namespace mesh;
namespace {

/// Cook's membrane of n x n quadrilaterals, E = 250 MPa, sheared by 6.25 MPa.
std::unique_ptr<Solid> cook(int n, double nu, FaceGradient gradient) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  for (Vec3& x : raw.points) x = Vec3(0.048 * x[0], 0.044 * x[0] + (0.044 - 0.028 * x[0]) * x[1], 0);
  SolidParameters p = box_parameters(2);
  p.material = {1000, 250e6, nu};
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "6.25e6"});
  auto solid = make_solid(raw, p);
  step(*solid, 1);
  return solid;
}

std::unique_ptr<Solid> beam(BoxCells cells, const std::array<int, 3>& n, double length,
                            FaceGradient gradient) {
  SolidParameters p = box_parameters(3);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "100", "0"});
  auto solid = make_solid(make_box(cells, n, Vec3::Zero(), Vec3(length, 1, 1)), p);
  step(*solid, 1);
  return solid;
}

void report(const char* what, const StrainAudit& audit) { fmt::print("{}: {}\n", what, audit.text()); }

TEST(Audit, fires_on_cook_at_nu_0_49_with_the_corrected_gradient) {
  const int before = diagnostics::doubts();
  const auto wrong = cook(16, 0.49, FaceGradient::corrected);
  report("Cook, nu 0.49, corrected", *wrong->judge().last_audit());
  EXPECT_TRUE(wrong->judge().last_audit()->is_doubtful());
  EXPECT_EQ(diagnostics::doubts(), before + 1);
}

TEST(Audit, is_silent_on_cook_with_the_symmetric_gradient_and_at_nu_one_third) {
  const int before = diagnostics::doubts();
  for (const double nu : {1. / 3, 0.49, 0.4999}) {
    const auto sound = cook(16, nu, FaceGradient::symmetric);
    report("Cook, symmetric", *sound->judge().last_audit());
    EXPECT_LT(sound->judge().last_audit()->mismatch(), 1e-6)
        << nu;  // a symmetric operator is never convicted by it
  }
  const auto sound = cook(16, 1. / 3, FaceGradient::corrected);
  report("Cook, nu 1/3, corrected", *sound->judge().last_audit());
  EXPECT_FALSE(sound->judge().last_audit()->is_doubtful());
  EXPECT_EQ(diagnostics::doubts(), before);
}

TEST(Audit, fires_on_two_long_tetrahedra_across_a_slender_beam) {
  const auto wrong = beam(BoxCells::tetrahedra, {16, 2, 2}, 40, FaceGradient::corrected);
  report("tetrahedra two across 40:1, corrected", *wrong->judge().last_audit());
  EXPECT_TRUE(wrong->judge().last_audit()->is_doubtful());
  const auto sound = beam(BoxCells::hexahedra, {40, 4, 4}, 10, FaceGradient::corrected);
  report("hexahedra four across 10:1, corrected", *sound->judge().last_audit());
  EXPECT_FALSE(sound->judge().last_audit()->is_doubtful());
}

// Stretched cells: stiff, and said by the difference of the gradients.
TEST(Audit, says_that_stretched_tetrahedra_are_stiff) {
  const auto stiff = beam(BoxCells::tetrahedra, {4, 4, 4}, 10, FaceGradient::symmetric);
  const auto sound = beam(BoxCells::tetrahedra, {40, 4, 4}, 10, FaceGradient::symmetric);
  report("tetrahedra 10:1 cells, symmetric", *stiff->judge().last_audit());
  report("tetrahedra 1:1 cells, symmetric", *sound->judge().last_audit());
  EXPECT_GT(stiff->judge().last_audit()->gradient_difference,
            2 * sound->judge().last_audit()->gradient_difference);
}

/// Tip deflection of a bar 20:1 of square quadrilaterals, n across, and the estimate of the mesh.
std::pair<double, double> plane_bar(int n, bool finite, const char* load) {
  SolidParameters p = box_parameters(2);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = FaceGradient::symmetric;
  if (finite) p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", load});
  const auto solid =
      make_solid(make_box(BoxCells::quadrilaterals, {20 * n, n, 1}, Vec3::Zero(), Vec3(20, 1, 0)), p);
  solid->collect_errors();
  step(*solid, 1);
  double tip = 0;
  for (const double u : solid->fields().point_displacement()) tip = std::max(tip, u);
  return {tip, solid->error_parts().mesh};
}

// Quadrilaterals are 1/(2 n^2) too stiff in bending, of which the difference of two gradients knows nothing.
TEST(Audit, estimates_how_stiff_quadrilaterals_bend) {
  for (const bool finite : {false, true}) {
    const char* load = finite ? "30" : "1";
    const double fine = plane_bar(12, finite, load).first;
    for (const int n : {2, 4}) {
      const auto [tip, told] = plane_bar(n, finite, load);
      const double wrong = std::abs(tip / fine - 1);
      fmt::print("{} across, {} strain: estimated {:.3g}, true {:.3g}\n", n, finite ? "large" : "small", told,
                 wrong);
      EXPECT_GT(told, wrong / 2);
      EXPECT_LT(told, wrong * 2);
    }
  }
  EXPECT_GT(plane_bar(1, false, "1").second, 0.2);
}

/// Tip deflection of a bar of square section, bent, and the audit of it.
std::pair<double, StrainAudit> bent_bar(BoxCells cells, const std::array<int, 3>& n, double length) {
  const auto solid = beam(cells, n, length, FaceGradient::symmetric);
  double tip = 0;
  for (const double u : solid->fields().point_displacement()) tip = std::max(tip, u);
  return {tip, *solid->judge().last_audit()};
}

// Hexahedra across a slender bar bend well, however the other gradient differs; recovered strains know it.
TEST(Audit, recovered_strains_estimate_how_hexahedra_bend) {
  for (const double length : {40., 100.}) {
    const double fine = bent_bar(BoxCells::hexahedra, {200, 4, 4}, length).first;
    const auto [tip, audit] = bent_bar(BoxCells::hexahedra, {20, 2, 2}, length);
    const double wrong = std::abs(tip / fine - 1);
    fmt::print("{}:1: recovered {:.3g}, gradients {:.3g}, true {:.3g}\n", length, *audit.recovered_difference,
               std::pow(audit.gradient_difference, 2), wrong);
    EXPECT_GT(audit.missed_by_mesh(3), wrong / 2);
    EXPECT_LT(audit.missed_by_mesh(3), wrong * 2);
    EXPECT_GT(std::pow(audit.gradient_difference, 2), 5 * wrong) << "the neighbour is no worse any more";
  }
}

/// A sheet that swings freely, judged every 0.2 s for as long as the run lasts.
struct Swing {
  double first_told = 0,
         ended = 0;    ///< created energy when the run first doubted itself, and time when it ended
  double created = 0;  ///< at the last judgement
  std::string cause;
};

/// `outputs`: written every twentieth step.
Swing swing(FaceGradient gradient, double until, bool outputs = true) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {2600, 1e7, 0.3};
  p.time_scheme.type = time::TimeScheme::trapezoidal;
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  p.initial_velocity = {{"0.1*x*sin(40*y)*cos(30*x)"}, {"0.2*x*x*sin(35*x)"}};
  RawMesh raw = make_box(BoxCells::triangles, {20, 4, 1}, Vec3::Zero(), Vec3(10, 1, 0));
  perturb_interior(raw, 0.3, 3);
  auto solid = make_solid(raw, p);
  Swing result;
  const int before = diagnostics::doubts();
  try {
    for (int i = 1; solid->stepper().state().time < until; ++i) {
      step(*solid, 0.01);
      solid->write_monitors(solid->stepper().state().time);
      if (outputs && i % 20 == 0) solid->write_output(solid->stepper().state().time, 0);
      if (diagnostics::doubts() > before && result.first_told == 0)
        result.first_told = solid->judge().energy_audit().created();
    }
  } catch (const Error& error) {
    result.cause = error.what();
    result.ended = solid->stepper().state().time;
  }
  result.created = solid->judge().energy_audit().created();
  return result;
}

// It ran to 1e75 J when nothing was written.
TEST(Audit, ends_a_motion_that_grows_between_outputs) {
  const Swing grows = swing(FaceGradient::corrected, 30, false);
  EXPECT_NE(grows.cause.find("spurious growth"), std::string::npos);
  EXPECT_LT(grows.created, 1e4);
  EXPECT_TRUE(swing(FaceGradient::symmetric, 30, false).cause.empty());
}

TEST(Audit, fires_on_undamped_motion_that_grows_out_of_nothing_and_ends_the_run) {
  const Swing grows = swing(FaceGradient::corrected, 30);
  fmt::print("told at {:+.3g}, ended at {} s: {}\n", grows.first_told, grows.ended, grows.cause);
  EXPECT_GT(grows.first_told, EnergyAudit::most_created_undriven);
  EXPECT_LT(grows.first_told, EnergyAudit::hopeless);
  EXPECT_GT(grows.ended, 0);
  EXPECT_NE(grows.cause.find("is not symmetric"), std::string::npos);
}

TEST(Audit, is_silent_on_undamped_motion_with_the_symmetric_gradient) {
  const Swing stays = swing(FaceGradient::symmetric, 3);
  EXPECT_EQ(stays.first_told, 0);
  EXPECT_EQ(stays.ended, 0);
  EXPECT_LT(std::abs(stays.created), 1e-6);
}

}  // namespace
}  // namespace couplet::testing::audit_test
