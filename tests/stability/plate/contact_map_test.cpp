// SPDX-License-Identifier: Apache-2.0
// 1000 bounces of a mass under gravity over contact stiffness and step: mechanism, the penalty's spring is
// met and left within a step, and a rule that does not know where adds or takes energy each time; criterion,
// the energy over that of the start. The conserving rule holds everywhere; the midpoint rule beside it is the
// failing neighbour.
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::contact_map_test {

/// Largest and last energy over the first, minus 1, in `bounces` bounces (or as long as they would take).
struct Drift {
  double largest = 0, last = 0;
};

Drift drift(ContactRule rule, double kappa, double dt, int bounces) {
  const double g = 9.81, speed = 1;
  test::Bounce one(kappa, 0, speed, rule, -g);
  const double first = one.now.energies.total();
  const long most = std::lround(bounces * (2 * speed / g + std::numbers::pi / std::sqrt(kappa)) / dt);
  Drift result;
  int done = 0;
  for (long i = 0; i < most && done < bounces && result.largest < 100; ++i) {
    const double before = one.now.v[0];
    one.step(dt);
    if (before < 0 && one.now.v[0] > 0) ++done;
    result.last = one.now.energies.total() / first - 1;
    result.largest = std::max(result.largest, result.last);
  }
  return result;
}

TEST(PlateContactMap, conserving_holds_over_stiffness_and_step_and_midpoint_does_not) {
  double worst_conserving = 0, worst_midpoint = 0;
  for (const double kappa : {1e3, 1e4, 1e5, 1e6, 1e7})
    for (const double dt : {3e-4, 1e-3, 3e-3, 1e-2}) {
      const Drift kept = drift(ContactRule::conserving, kappa, dt, 1000);
      const Drift plain = drift(ContactRule::midpoint, kappa, dt, 1000);
      EXPECT_LT(kept.largest, 1e-8) << kappa << " " << dt;
      EXPECT_GT(kept.last, -1e-8) << kappa << " " << dt;
      worst_conserving = std::max({worst_conserving, kept.largest, -kept.last});
      worst_midpoint = std::max(worst_midpoint, plain.largest);
      RecordProperty(
          fmt::format("map-{:g}-{:g}", kappa, dt),
          fmt::format("{:.3e} {:.3e} {:.3e} {:.3e}", kept.largest, kept.last, plain.largest, plain.last));
    }
  EXPECT_GT(worst_midpoint, 0.1);
  RecordProperty("conserving", fmt::format("{:.3e}", worst_conserving));
  RecordProperty("midpoint", fmt::format("{:.3e}", worst_midpoint));
}

}  // namespace couplet::plate::contact_map_test
