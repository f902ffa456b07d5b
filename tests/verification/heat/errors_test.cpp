// SPDX-License-Identifier: Apache-2.0
// What a run of conduction says of its own error, against a mode of a slab.
#include "solid_solver/thermal/heat_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/diagnostics/finding.hpp"
#include "common/io/checkpoint.hpp"
#include "tests/verification/heat/support.hpp"

namespace couplet::testing::errors_test {
using namespace mesh;
namespace {

// A slab |x| < 1, convection Bi = 1 on its faces, z tan z = Bi: the slowest mode, exp(-z^2 Fo) cos(z x), which nothing disturbs.
constexpr double z = 0.8603335890193797;
double cooled(double x, double fo) { return std::exp(-z * z * fo) * std::cos(z * x); }
const double mean_before = std::sin(z) / z;

struct Outcome {
  diagnostics::ErrorParts parts;
  double wrong = 0;  ///< true error over the size of the variation
};

HeatParameters cooling(HeatScheme scheme) {
  HeatParameters p;
  p.scheme = scheme;
  p.initial_temperature = {"cos(0.8603335890193797*x)"};
  p.boundaries["xmin"].type = HeatType::symmetry;
  p.boundaries["xmax"] = convection("1", "0");
  return p;
}

/// n cells, so many steps; with `again` the estimate goes on from its state after every step.
Outcome slab(int n, int steps, HeatScheme scheme, bool again = false) {
  const HeatParameters p = cooling(scheme);
  HeatCase scene(make_box(BoxCells::quadrilaterals, {n, 4, 1}, Vec3::Zero(), Vec3(1, 0.4, 0)),
                 {{1, 1.0, 1.0}}, p);
  auto errors = std::make_unique<HeatErrors>(scene.mesh(), scene.geometry(), p);
  for (int i = 0; i < steps; ++i) {
    const HeatState& now = scene.heat->accepted();
    scene.heat->solve({now.time, 0.5 / steps, coupling::Scheme::standalone, now.steps});
    errors->see_step(scene.heat->accepted(), scene.heat->trial());
    scene.heat->accept_step();
    if (!again) continue;
    io::StateInMemory state;
    io::CheckpointWriter writer(state);
    errors->save(writer);
    errors = std::make_unique<HeatErrors>(scene.mesh(), scene.geometry(), p);
    io::CheckpointReader reader(state);
    errors->load(reader);
  }
  const double size = scene.error([](const Vec3&) { return mean_before; });
  return {errors->parts(*scene.heat), scene.error([](const Vec3& x) { return cooled(x[0], 0.5); }) / size};
}

TEST(HeatErrors, coarse_cells_dominate_where_they_do) {
  const Outcome found = slab(4, 200, HeatScheme::trapezoidal);
  fmt::print("mesh {:.2e}, step {:.2e}, true {:.2e}\n", found.parts.mesh, found.parts.step, found.wrong);
  EXPECT_GT(found.parts.mesh, 10 * found.parts.step);
  EXPECT_GT(found.parts.mesh, found.wrong / 4);
  EXPECT_LT(found.parts.mesh, found.wrong * 4);
}

TEST(HeatErrors, long_steps_dominate_where_they_do) {
  for (const HeatScheme scheme : {HeatScheme::euler, HeatScheme::three_point, HeatScheme::trapezoidal}) {
    const Outcome found = slab(80,
                               scheme == HeatScheme::euler         ? 20
                               : scheme == HeatScheme::three_point ? 8
                                                                   : 4,
                               scheme);
    fmt::print("scheme {}: mesh {:.2e}, step {:.2e}, true {:.2e}\n", int(scheme), found.parts.mesh,
               found.parts.step, found.wrong);
    EXPECT_GT(found.parts.step, 3 * found.parts.mesh) << int(scheme);
    EXPECT_GT(found.parts.step, found.wrong / 4) << int(scheme);
    EXPECT_LT(found.parts.step, found.wrong * 4) << int(scheme);
  }
}

TEST(HeatErrors, a_run_that_goes_on_says_the_same) {
  const diagnostics::ErrorParts whole = slab(8, 12, HeatScheme::three_point).parts,
                                stopped = slab(8, 12, HeatScheme::three_point, true).parts;
  EXPECT_EQ(whole.step, stopped.step);
  EXPECT_EQ(whole.mesh, stopped.mesh);
}

/// Hardly a cell a rank: all must agree when the swing is told.
TEST(HeatSwing, is_told_once_on_any_number_of_ranks) {
  HeatParameters p;
  p.scheme = HeatScheme::trapezoidal;
  p.initial_temperature = {"0"};
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "1");
  HeatCase scene(make_box(BoxCells::quadrilaterals, {4, 1, 1}, Vec3::Zero(), Vec3(1, 0.25, 0)),
                 {{1, 1.0, 1.0}}, p);
  const int before = diagnostics::doubts();
  for (int i = 0; i < 40; ++i) scene.step(1000);
  EXPECT_EQ(diagnostics::doubts() - before, 1);
}

TEST(HeatErrors, a_linear_field_errs_nowhere_and_one_temperature_says_nothing) {
  HeatParameters p = steady();
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "300");
  p.boundaries["xmax"] = heat_boundary(HeatType::temperature, "400");
  for (const bool level : {false, true}) {
    if (level) p.boundaries["xmax"].value = {"300"};
    HeatCase scene(make_box(BoxCells::quadrilaterals, {6, 3, 1}, Vec3::Zero(), Vec3(1, 1, 0)),
                   {{1, 1.0, 1.0}}, p);
    const HeatErrors errors(scene.mesh(), scene.geometry(), p);
    scene.step(1);
    const diagnostics::ErrorParts parts = errors.parts(*scene.heat);
    if (level) {
      EXPECT_FALSE(parts.known());
    } else {
      EXPECT_LT(parts.mesh, 1e-8);
      EXPECT_TRUE(std::isnan(parts.step));
    }
  }
}

}  // namespace
}  // namespace couplet::testing::errors_test
