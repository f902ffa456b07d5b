// SPDX-License-Identifier: Apache-2.0
// Vibrations that the load of a partner excites in a body of large strain and that turn round from step to step.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/parallel/collective.hpp"
#include "tests/verification/solid/partner_load.hpp"

namespace couplet::testing::partner_vibration_test {
using time::TimeScheme;
namespace {

/// Second differences of the velocity over three steps, squared: what turns round from step to step counts 16 times, what takes many steps
/// nothing.
double turning(const std::array<std::vector<double>, 3>& v) {
  double sum = 0;
  for (std::size_t i = 0; i < v[0].size(); ++i) sum += std::pow(v[2][i] - 2 * v[1][i] + v[0][i], 2);
  return parallel::sum(MPI_COMM_WORLD, sum);
}

/// What is left of a vibration 100 steps after the load that excited it and turned round each step.
double left_of_a_vibration(TimeScheme scheme) {
  const auto solid = sheet(scheme);
  const coupling::Interface interface = solid->initialise();
  std::array<std::vector<double>, 3> v;
  double excited = 0, left = 0;
  for (int i = 0; i < 110; ++i) {
    step_under(*solid, interface, 0.4, i >= 10 ? 0 : i % 2 == 0 ? 100 : -100);
    v = {v[1], v[2], solid->stepper().state().cell_v};
    if (i >= 2 && i < 10) excited = std::max(excited, turning(v));
    if (i >= 100) left = std::max(left, turning(v));
  }
  fmt::print("{}: {:.2g} of a vibration's energy is left\n", time::name(scheme), left / excited);
  return left / excited;
}

TEST(PartnerVibration, dies_out_by_the_default_scheme) {
  EXPECT_LT(left_of_a_vibration(TimeScheme::automatic), 0.02);
}

TEST(PartnerVibration, stays_with_the_trapezoidal_rule) {
  EXPECT_GT(left_of_a_vibration(TimeScheme::trapezoidal), 0.3);
}

}  // namespace
}  // namespace couplet::testing::partner_vibration_test
