// SPDX-License-Identifier: Apache-2.0
// A surface that is heated at once, with steps from half of what the first cell conducts in to a thousand times that.
#include <gtest/gtest.h>

#include <cmath>

#include "common/diagnostics/finding.hpp"
#include "tests/verification/heat/support.hpp"

namespace couplet::testing::thermal_shock_test {
namespace {

struct Shock {
  double beyond = 0;  ///< largest distance of a temperature from between the old (0) and the new one (1)
  int told = 0;       ///< doubts of the program
  double back = 0;    ///< largest cooling of a cell in a step: the exact temperature only rises
};

Shock shock(HeatScheme scheme, double fourier) {
  constexpr Index n = 40;
  HeatParameters p;
  p.scheme = scheme;
  p.initial_temperature = {"0"};
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "1");
  HeatCase scene(
      mesh::make_box(mesh::BoxCells::quadrilaterals, {int(n), 1, 1}, Vec3::Zero(), Vec3(1, 0.1, 0)),
      {{1, 1.0, 1.0}}, p);
  Shock result;
  const int before_it = diagnostics::doubts();
  for (int i = 0; i < 60; ++i) {
    std::vector<double> before;
    for (Index c = 0; c < n; ++c) before.push_back(scene.temperature(c));
    scene.step(fourier / (n * n));
    for (Index c = 0; c < n; ++c) {
      const double t = scene.temperature(c);
      result.beyond = std::max({result.beyond, -t, t - 1});
      result.back = std::max(result.back, before[std::size_t(c)] - t);
    }
  }
  result.told = diagnostics::doubts() - before_it;
  return result;
}

// Mechanism: modes that a step does not resolve must decay, not change their sign.
TEST(ThermalShock, does_not_oscillate_with_eulers_scheme_whatever_the_step) {
  for (const double fourier : {0.5, 10.0, 1000.0}) {
    const Shock s = shock(HeatScheme::euler, fourier);
    EXPECT_LT(s.beyond, 1e-12) << fourier;
    EXPECT_LT(s.back, 1e-12) << fourier;
    EXPECT_EQ(s.told, 0);
  }
}

TEST(ThermalShock, with_the_three_point_scheme_overshoots_by_two_per_cent_at_most_and_by_nothing_up_to_ten) {
  for (const double fourier : {0.5, 10.0}) {
    EXPECT_LT(shock(HeatScheme::three_point, fourier).beyond, 1e-12) << fourier;
    EXPECT_LT(shock(HeatScheme::three_point, fourier).back, 1e-12) << fourier;
  }
  const Shock s = shock(HeatScheme::three_point, 1000);
  RecordProperty("overshoot", fmt::format("{:.3f}", s.beyond));
  EXPECT_LT(s.beyond, 0.025);
}

TEST(ThermalShock, swings_by_half_and_more_with_the_trapezoidal_rule_and_that_is_told_once) {
  const Shock short_steps = shock(HeatScheme::trapezoidal, 0.5);
  EXPECT_LT(short_steps.beyond, 1e-12);
  EXPECT_EQ(short_steps.told, 0);
  for (const double fourier : {10.0, 1000.0}) {
    const Shock s = shock(HeatScheme::trapezoidal, fourier);
    EXPECT_GT(s.beyond, 0.5) << fourier;
    EXPECT_EQ(s.told, 1) << fourier;
  }
}

}  // namespace
}  // namespace couplet::testing::thermal_shock_test
