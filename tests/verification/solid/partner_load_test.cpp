// SPDX-License-Identifier: Apache-2.0
// A body of large strain that a partner loads: which scheme integrates it, its order in time with loads that are means over a step, restart.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/partner_load.hpp"

namespace couplet::testing::partner_load_test {
using namespace coupling;
using time::TimeScheme;
namespace {

/// Of the end [Pa].
double pull(double t) { return 300 * std::sin(4 * t) * std::sin(4 * t); }
/// Over a step, by Simpson's rule.
double mean_pull(double t, double dt) { return (pull(t) + 4 * pull(t + dt / 2) + pull(t + dt)) / 6; }

void push(Solid& solid, const Interface& interface, double dt) {
  step_under(solid, interface, dt, mean_pull(solid.stepper().state().time, dt));
}

constexpr double end_time = 0.8;

/// Cells at the end time, by n steps; uneven: every second one twice as long.
std::vector<double> moved_by(TimeScheme scheme, int n, bool uneven) {
  const auto solid = sheet(scheme);
  const Interface interface = solid->initialise();
  for (int i = 0; i < n; ++i)
    push(*solid, interface, uneven ? end_time / (1.5 * n) * (1 + i % 2) : end_time / n);
  return solid->stepper().state().cell_u;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = std::max(difference, std::abs(a[i] - b[i])), size = std::max(size, std::abs(a[i]));
  return parallel::max(MPI_COMM_WORLD, difference) / parallel::max(MPI_COMM_WORLD, size);
}

TEST(PartnerLoad, at_large_strain_is_taken_by_a_scheme_that_damps_the_highest_modes_and_elsewhere_not) {
  SolidParameters p = pushed(TimeScheme::automatic);
  EXPECT_EQ(scheme_of(p).type, TimeScheme::generalised_alpha);
  p.energy_momentum = true;
  EXPECT_EQ(scheme_of(p).type, TimeScheme::trapezoidal);
  p.energy_momentum = false;
  p.kinematics = SolidParameters::Kinematics::small_strain;
  EXPECT_EQ(scheme_of(p).type, TimeScheme::trapezoidal);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.boundaries["xmax"] = boundary(Type::free);
  EXPECT_EQ(scheme_of(p).type, TimeScheme::trapezoidal);
  p.time_scheme.type = TimeScheme::bathe;
  EXPECT_EQ(scheme_of(p).type, TimeScheme::bathe);
}

TEST(PartnerLoad, is_taken_to_second_order_in_time) {
  const std::vector<double> exact = moved_by(TimeScheme::trapezoidal, 1280, false);
  for (const TimeScheme scheme :
       {TimeScheme::automatic, TimeScheme::trapezoidal, TimeScheme::bathe, TimeScheme::three_point})
    for (const bool uneven : {false, true}) {
      const double coarse = apart(exact, moved_by(scheme, 80, uneven)),
                   fine = apart(exact, moved_by(scheme, 320, uneven)), slope = 0.5 * std::log2(coarse / fine);
      fmt::print("{}{}: {:.2e} {:.2e}, slope {:.2f}\n", time::name(scheme), uneven ? ", uneven" : "", coarse,
                 fine, slope);
      EXPECT_GT(slope, 1.85);
      EXPECT_LT(fine, 2e-3);
    }
}

TEST(PartnerLoad, goes_on_bit_for_bit_from_a_checkpoint) {
  const auto run = sheet(TimeScheme::automatic), restarted = sheet(TimeScheme::automatic);
  const Interface interface = run->initialise();
  restarted->initialise();
  for (const double dt : {0.02, 0.01, 0.02}) push(*run, interface, dt);
  support::SavedState(*run).load_into(*restarted);
  for (const double dt : {0.01, 0.02}) push(*run, interface, dt), push(*restarted, interface, dt);
  EXPECT_EQ(run->stepper().state().cell_u, restarted->stepper().state().cell_u);
  EXPECT_EQ(run->fields().point_velocity(), restarted->fields().point_velocity());
}

}  // namespace
}  // namespace couplet::testing::partner_load_test
