// SPDX-License-Identifier: Apache-2.0
// Structures that break schemes: steps that jump by a factor of 100, cells of aspect 1000, stiffness that jumps by 1e6.
// Each stands beside the neighbour that fails, and that neighbour is told.
#include <gtest/gtest.h>

#include <cmath>

#include "common/diagnostics/finding.hpp"
#include "swing.hpp"

namespace couplet::testing::hard_cases_test {
using namespace mesh;
using namespace time;
namespace {

// Mechanism: a scheme that carries an acceleration or an earlier level along weighs it by a step that is gone.
const std::vector<double> jumping{1e-3, 0.1, 0.1, 1e-3, 1e-3, 0.1, 3e-3, 0.05};

TEST(StepsThatJumpByAHundred, leave_the_energy_of_the_other_schemes_alone) {
  for (const TimeScheme scheme :
       {TimeScheme::euler, TimeScheme::three_point, TimeScheme::trapezoidal, TimeScheme::bathe})
    for (const double lean : {0.0, 1.0}) {
      const Swing s = swing(sheet(lean), free_swing(scheme, FaceGradient::symmetric), jumping, 240);
      EXPECT_FALSE(s.ended) << s.cause;
      EXPECT_LT(s.growth, 1e-8) << name(scheme) << ", lean " << lean;
    }
}

TEST(StepsThatJumpByAHundred, make_generalised_alpha_grow_and_the_run_ends_with_the_cause) {
  const SolidParameters p = free_swing(TimeScheme::generalised_alpha, FaceGradient::symmetric);
  const Swing jumps = swing(sheet(0), p, jumping, 800), even = swing(sheet(0), p, {0.05}, 240);
  fmt::print("generalised-alpha: {:.3g}, {}\n", jumps.growth, jumps.cause);
  EXPECT_GT(jumps.growth, 1);
  EXPECT_TRUE(jumps.ended) << "grew by " << jumps.growth;
  EXPECT_FALSE(even.ended);
  EXPECT_LT(even.growth, 1e-8);
}

struct Plate {
  double over_beam = 0;  ///< displacement at the end over that of the theory of bars and beams
  bool doubted = false;
};

/// 16 cells along, each `aspect` times as long as high.
Plate plate(FaceGradient gradient, double aspect, bool pull) {
  constexpr int along = 16, across = 16;
  const double length = along, height = across / aspect, modulus = 1e6 / (1 - 0.3 * 0.3);
  SolidParameters p = box_parameters(2);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {pull ? "1" : "0", pull ? "0" : "1e-3"});
  const auto solid = make_solid(
      make_box(BoxCells::quadrilaterals, {along, across, 1}, Vec3::Zero(), Vec3(length, height, 0)), p);
  step(*solid, 1);
  const std::vector<double> moved = solid->fields().point_displacement();
  const Geometry& geometry = solid->body().geometry();
  double end = 0;
  for (std::size_t i = 0; i < geometry.points.size(); ++i)
    if (geometry.points[i][0] > length - 1e-6) end = moved[2 * i + (pull ? 0 : 1)];
  const double beam = pull ? length / modulus
                           : 1e-3 * height * std::pow(length, 3) / (3 * modulus * std::pow(height, 3) / 12);
  return {end / beam, solid->judge().last_audit()->is_doubtful()};
}

// Mechanism: differences along the long side do not see the bending between two cells.
TEST(CellsOfAspectAThousand, are_pulled_right_by_all_gradients_and_bent_the_right_way_by_the_symmetric_one) {
  for (const FaceGradient gradient :
       {FaceGradient::thesis, FaceGradient::corrected, FaceGradient::symmetric}) {
    const Plate pulled = plate(gradient, 1000, true);
    EXPECT_NEAR(pulled.over_beam, 1, 0.01);
    EXPECT_FALSE(pulled.doubted);
  }
  const Plate bent = plate(FaceGradient::symmetric, 1000, false);
  RecordProperty("bent", fmt::format("{:.3f}", bent.over_beam));
  EXPECT_GT(bent.over_beam, 0.7);
  EXPECT_LT(bent.over_beam, 1.15);
}

TEST(CellsOfAspectAThousand, bend_wrongly_with_the_other_gradients_and_that_is_told) {
  for (const FaceGradient gradient : {FaceGradient::thesis, FaceGradient::corrected}) {
    const int before = diagnostics::doubts();
    const Plate bent = plate(gradient, 1000, false);
    EXPECT_LT(bent.over_beam, 0.1);
    EXPECT_TRUE(bent.doubted);
    EXPECT_EQ(diagnostics::doubts(), before + 1);
  }
}

TEST(CellsOfAspectAThousand, keep_the_energy_of_a_swing_with_the_symmetric_gradient) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {10, 8, 1}, Vec3::Zero(), Vec3(1, 8e-4, 0));
  const Swing s = swing(raw, free_swing(TimeScheme::trapezoidal, FaceGradient::symmetric), {0.01}, 300);
  EXPECT_FALSE(s.ended) << s.cause;
  EXPECT_LT(std::abs(s.growth), 1e-3);
}

SolidParameters two_materials(SolidParameters p, double nu) {
  p.materials["soft"] = {{1000, 1e5, nu, {}}, {}};
  p.materials["hard"] = {{1000, 1e11, nu, {}}, {}};
  return p;
}

/// From x = 0.5 on a million times as stiff.
RawMesh joined(RawMesh raw, double from) {
  raw.zones = {"soft", "hard"};
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    raw.cell_zone[c] = raw.points[raw.cell_points[c][0]][0] > from;
  return raw;
}

// Mechanism: unsymmetric terms of the interface are as large as the stiff side, the soft side's modes small beside them.
TEST(StiffnessThatJumpsByAMillion, keeps_the_energy_of_a_swing_with_the_symmetric_gradient) {
  for (const double lean : {0.0, 1.0}) {
    const Swing s =
        swing(joined(sheet(lean), 0.45),
              two_materials(free_swing(TimeScheme::trapezoidal, FaceGradient::symmetric), 0.3), {0.01}, 300);
    EXPECT_FALSE(s.ended) << s.cause;
    EXPECT_LT(s.growth, 1e-8) << lean;
  }
}

TEST(StiffnessThatJumpsByAMillion, grows_with_the_thesiss_gradient_on_leaning_cells_and_the_run_ends) {
  const Swing s =
      swing(joined(sheet(1), 0.45),
            two_materials(free_swing(TimeScheme::trapezoidal, FaceGradient::thesis), 0.3), {0.01}, 1000);
  EXPECT_TRUE(s.ended) << "grew by " << s.growth;
  EXPECT_NE(s.cause.find("is not symmetric"), std::string::npos) << s.cause;
}

TEST(StiffnessThatJumpsByAMillion, is_stretched_as_two_springs_in_a_row) {
  for (const FaceGradient gradient :
       {FaceGradient::thesis, FaceGradient::corrected, FaceGradient::symmetric}) {
    SolidParameters p = two_materials(box_parameters(2), 0.0);
    p.method.face_gradient = gradient;
    p.method.relative_tolerance = 1e-12;
    p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
    p.boundaries["xmax"] = boundary(Type::traction, {"10", "0"});
    const auto solid = make_solid(joined(sheet(0), 0.45), p);
    step(*solid, 1);
    const std::vector<double> moved = solid->fields().point_displacement();
    const Geometry& geometry = solid->body().geometry();
    for (std::size_t i = 0; i < geometry.points.size(); ++i) {
      const double x = geometry.points[i][0];
      EXPECT_NEAR(moved[2 * i], x < 0.5 ? 1e-4 * x : 5e-5 + 1e-10 * (x - 0.5), 1e-10) << x;
    }
  }
}

}  // namespace
}  // namespace couplet::testing::hard_cases_test
