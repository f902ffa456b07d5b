// SPDX-License-Identifier: Apache-2.0
// Vibrations that the load of a partner excites in a body of large strain, at two steps per period.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"
#include "tests/verification/solid/partner_load.hpp"

namespace couplet::testing {
using time::TimeScheme;
namespace {

/// Kinetic energy, but for a constant.
double swing(const Solid& solid) {
  double sum = 0;
  const std::size_t n = std::size_t(solid.body().mesh().cells.n_owned()) * 2;
  for (std::size_t i = 0; i < n; ++i) sum += std::pow(solid.stepper().state().cell_v[i], 2);
  return parallel::sum(MPI_COMM_WORLD, sum);
}

/// What is left of a vibration at two steps per period 60 steps after the load that excited it.
double left_of_a_vibration(TimeScheme scheme) {
  const auto solid = sheet(scheme);
  const coupling::Interface interface = solid->initialise();
  constexpr double dt = 0.1;
  for (int i = 0; i < 8; ++i) step_under(*solid, interface, dt, i % 2 == 0 ? 100 : -100);
  const double excited = swing(*solid);
  double left = 0;
  for (int i = 0; i < 60; ++i) {
    step_under(*solid, interface, dt, 0);
    if (i >= 50) left = std::max(left, swing(*solid));
  }
  fmt::print("{}: {:.2g} of the energy of a vibration is left\n", time::name(scheme), left / excited);
  return left / excited;
}

TEST(PartnerVibration, dies_out_by_the_default_scheme) {
  EXPECT_LT(left_of_a_vibration(TimeScheme::automatic), 0.02);
}

TEST(PartnerVibration, stays_with_the_trapezoidal_rule) {
  EXPECT_GT(left_of_a_vibration(TimeScheme::trapezoidal), 0.3);
}

}  // namespace
}  // namespace couplet::testing
