// SPDX-License-Identifier: Apache-2.0
// Ten years of daily cycles of a filler that slides between the active and the passive load: the wall's stress stays between
// the two, for ever the same from the second cycle on.
#include "tests/support/test.hpp"
#include "thermocline/wall/mechanics.hpp"

namespace couplet::thermocline::ratcheting_test {

struct Cycles {
  double highest = 0, lowest = 1e300;  ///< lateral over vertical pressure
  double drift = 0;                    ///< of the hoop stress from cycle 2 to the last, over that of cycle 2
  bool slides = false;
};

/// `hot` as it is in cycle k: constant, or scattered by up to `scatter` [K].
Cycles run(double hot, double scatter, int count, const Filler& filler = {}) {
  const BedGrid bed({{10, 0.22, 0.005}}, 10);
  ShellParameters shell;
  shell.plates = {{10, 0.02}};
  const Rings rings(shell, bed, 18, 0);
  const InnerPressure p = inner_pressure(rings, bed, caloria_ht43(), filler, 0);
  const std::vector<double> cold(10, 400);
  const Steel steel = steel_a537();
  FillerMechanics m(rings, steel, filler, p, cold, cold);
  Cycles result;
  std::vector<double> second;
  for (int k = 0; k < count; ++k) {
    const std::vector<double> top(10, hot + scatter * std::sin(0.37 * k * k));
    for (const std::vector<double>* t : {&top, &cold}) {
      m.update(*t, *t);
      for (int i = 0; i < rings.size(); ++i) {
        const double ratio = m.lateral()[i] / p.vertical[i];
        result.highest = std::max(result.highest, ratio);
        result.lowest = std::min(result.lowest, ratio);
        result.slides |= m.contact()[i] == Contact::passive;
      }
    }
    if (k == 1) second.assign(m.hoop().begin(), m.hoop().end());
    if (k > 1 && scatter == 0)
      for (int i = 0; i < rings.size(); ++i)
        result.drift = std::max(result.drift, std::abs(m.hoop()[i] / second[i] - 1));
  }
  return result;
}

// K_a = 1/3 and K_p = 3 at an angle of friction of 30 degrees: between them lies every stress that the filler can hold.
TEST(Ratcheting, of_3650_equal_cycles_is_bounded_and_the_same_from_the_second_on) {
  const Cycles slides = run(600, 0, 3650);
  EXPECT_TRUE(slides.slides);
  EXPECT_GE(slides.lowest, 1. / 3 - 1e-9);
  EXPECT_LE(slides.highest, 3 + 1e-9);
  EXPECT_LT(slides.drift, 1e-9);
  RecordProperty("drift", fmt::format("{:.1e}", slides.drift));
}

TEST(Ratcheting, of_3650_scattered_cycles_stays_between_the_active_and_the_passive_load) {
  const Cycles slides = run(580, 30, 3650);
  EXPECT_TRUE(slides.slides);
  EXPECT_GE(slides.lowest, 1. / 3 - 1e-9);
  EXPECT_LE(slides.highest, 3 + 1e-9);
}

// The neighbour: grains that friction holds whatever pushes them (80 degrees: K_p 130) take the whole squeeze of each cooling.
TEST(Ratcheting, of_a_filler_that_does_not_slide_passes_that_load) {
  Filler stuck;
  stuck.friction_angle = 80 * M_PI / 180;
  const Cycles held = run(600, 0, 3650, stuck);
  EXPECT_GT(held.highest, 3.3);
}

// Cycles of 5 K; of 10 K slide.
TEST(Ratcheting, of_small_cycles_never_reaches_the_passive_load) {
  const Cycles held = run(405, 0, 3650);
  EXPECT_FALSE(held.slides);
  EXPECT_LT(held.highest, 3);
  EXPECT_LT(held.drift, 1e-9);
}

}  // namespace couplet::thermocline::ratcheting_test
