// SPDX-License-Identifier: Apache-2.0
// Cases that break a careless bed: each stays within the temperatures that went in and keeps its heat.
#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::hard_cases_test {

/// Runs a bed and keeps its books, step by step.
struct Audit {
  PackedBed bed;
  double low, high;
  double worst_step = 0;  // imbalance of a step over the heat that the bed holds between low and high
  double beyond = 0;      // furthest outside [low, high], over its width
  double entered = 0, start;

  Audit(PackedBed b, double l, double h) : bed(std::move(b)), low(l), high(h), start(bed.energy(l)) {}
  double scale() const { return bed.heat_capacity() * (high - low); }
  void step(double mass_flow, double inlet) {
    const double before = bed.energy(low);
    const BedHeat heat = bed.step(mass_flow, inlet);
    entered += heat.by_flow + heat.by_source;
    worst_step =
        std::max(worst_step, std::abs(bed.energy(low) - before - heat.by_flow - heat.by_source) / scale());
    for (const double t : temperatures_of(bed))
      beyond = std::max({beyond, (low - t) / (high - low), (t - high) / (high - low)});
  }
  double drift() const { return std::abs(bed.energy(low) - start - entered) / scale(); }
};

struct Case {
  Advection advection;
  const char* name;
};
class HardCase : public ::testing::TestWithParam<Case> {
 protected:
  Audit make(double diameter, double film, double start = 400, int cells = 200) const {
    BedParameters p = plain_bed(cells, 10, 0.3, diameter);
    p.closures.conductivity = 0.5;
    p.closures.film_coefficient = film;
    p.shells = 5;
    p.advection = GetParam().advection;
    p.initial_temperature = start;
    return Audit(PackedBed(p, constant_fluid(1800, 1500, 0.5, 2e-3), Filler{}, 10), 300, 400);
  }
  double step_of(const Audit& a, double mass_flow) const {
    return GetParam().advection == Advection::implicit ? 20 : a.bed.largest_step(mass_flow);
  }
  void expect_sound(const Audit& a) {
    RecordProperty("worst_step", fmt::format("{:.3e}", a.worst_step));
    RecordProperty("drift", fmt::format("{:.3e}", a.drift()));
    RecordProperty("beyond", fmt::format("{:.3e}", a.beyond));
    EXPECT_LT(a.worst_step, 1e-10);
    EXPECT_LT(a.drift(), 1e-9);
    EXPECT_LT(a.beyond, 1e-8);
  }
};

TEST_P(HardCase, sharp_front) {
  Audit a = make(0.01, 100);
  std::vector<double> t(200, 300);
  std::fill(t.begin() + 100, t.end(), 400);
  a.bed.set_temperature(t);
  a.start = a.bed.energy(a.low);
  a.bed.prepare(step_of(a, 50), 50);
  for (int i = 0; i < 600; ++i) a.step(50, 300);
  expect_sound(a);
}

TEST_P(HardCase, reversal_every_step) {
  Audit a = make(0.01, 100, 350);
  a.bed.prepare(step_of(a, 50), 50);
  for (int i = 0; i < 600; ++i) a.step(i % 2 ? 50 : -50, i % 2 ? 300 : 400);
  expect_sound(a);
}

TEST_P(HardCase, rest_with_a_sharp_profile) {
  Audit a = make(0.01, 100);
  std::vector<double> t(200);
  for (int i = 0; i < 200; ++i) t[i] = (i / 10) % 2 ? 300 : 400;
  a.bed.set_temperature(t);
  a.start = a.bed.energy(a.low);
  a.bed.prepare(600, 0);
  for (int i = 0; i < 1000; ++i) a.step(0, 300);
  expect_sound(a);
}

TEST_P(HardCase, grains_of_a_micrometre) {
  Audit a = make(1e-6, 0);  // film by Wakao's correlation: 1e12 W/(m^3 K)
  a.bed.prepare(step_of(a, 50), 50);
  for (int i = 0; i < 600; ++i) a.step(50, 300);
  expect_sound(a);
  EXPECT_GT(a.bed.top() - a.bed.bottom(), 99);  // and the front is there
}

TEST_P(HardCase, biot_number_of_a_thousand) {
  const double diameter = 0.2;
  Audit a = make(diameter, 1e3 * Filler{}.conductivity(300) / (diameter / 2));
  a.bed.prepare(step_of(a, 50), 50);
  for (int i = 0; i < 600; ++i) a.step(50, 300);
  expect_sound(a);
}

INSTANTIATE_TEST_SUITE_P(Scheme, HardCase,
                         ::testing::Values(Case{Advection::upwind, "upwind"}, Case{Advection::tvd, "tvd"},
                                           Case{Advection::implicit, "implicit"}),
                         [](const auto& info) { return info.param.name; });

// The neighbour of all: a step that carries a front through some cells throws its temperatures out of what went in.
TEST(Overstepped, upwind_far_beyond_its_limit_leaves_the_bounds) {
  for (const double share : {1.0, 5.0}) {
    BedParameters p = plain_bed(200, 10, 0.3, 0.01);
    p.closures.film_coefficient = 100;
    p.advection = Advection::upwind;
    p.courant = 1;
    p.initial_temperature = 400;
    Audit a(PackedBed(p, constant_fluid(1800, 1500, 0.5), Filler{}, 10), 300, 400);
    a.bed.prepare(share * a.bed.largest_step(50), 50);
    for (int i = 0; i < 60; ++i) a.step(50, 300);
    if (share > 1)
      EXPECT_GT(a.beyond, 0.1);
    else
      EXPECT_LT(a.beyond, 1e-8);
  }
}

TEST(Implicit, ten_times_the_advective_limit_stays_bounded_and_keeps_the_heat) {
  BedParameters p = plain_bed(200, 10, 0.3, 0.01);
  p.closures.film_coefficient = 100;
  p.advection = Advection::upwind;
  p.courant = 1;
  p.initial_temperature = 400;
  const Medium fluid = constant_fluid(1800, 1500, 0.5);
  const double limit = PackedBed(p, fluid, Filler{}, 10).largest_step(50);
  p.advection = Advection::implicit;
  Audit a(PackedBed(p, fluid, Filler{}, 10), 300, 400);
  a.bed.prepare(10 * limit, 50);
  for (int i = 0; i < 500; ++i) a.step(50, 300);
  RecordProperty("worst_step", fmt::format("{:.3e}", a.worst_step));
  RecordProperty("beyond", fmt::format("{:.3e}", a.beyond));
  EXPECT_LT(a.worst_step, 1e-10);
  EXPECT_LT(a.beyond, 1e-8);
  // The front travels as theory says.
  double mean = 0;
  const auto t = a.bed.fluid();
  for (int i = 0; i < 200; ++i) mean += (400 - t[i]) / 100 * 0.05;
  const double travelled = 50 * fluid.specific_heat * 500 * 10 * limit * 10 / a.bed.heat_capacity();
  if (travelled < 7) {
    EXPECT_NEAR(mean, travelled, 0.02 * travelled);
  }
}

TEST(EnergyBalance, three_months_of_daily_cycles_close) {
  for (const Advection advection : {Advection::upwind, Advection::tvd}) {
    BedParameters p = plain_bed(120, 12, 0.22, 0.0046);
    p.closures.conduction = Conduction::wakao;
    p.advection = advection;
    p.initial_temperature = 563.15;
    Audit a(PackedBed(p, solar_salt(), Filler{}, 40), 563.15, 663.15);
    double moved = 0, worst = 0;
    for (int day = 0; day < 91; ++day)
      for (const double flow : {-600.0, 0.0, 600.0, 0.0}) {
        const double span = 6 * 3600, longest = std::min(600.0, a.bed.largest_step(flow));
        const int n = int(std::ceil(span / longest));
        a.bed.prepare(span / n, flow);
        for (int i = 0; i < n; ++i) {
          const double before = a.bed.energy(a.low);
          const auto heat = a.bed.step(flow, flow < 0 ? a.high : a.low);
          a.entered += heat.by_flow;
          moved += std::abs(heat.by_flow);
          worst = std::max(worst, std::abs(a.bed.energy(a.low) - before - heat.by_flow) / a.scale());
        }
      }
    const double drift = std::abs(a.bed.energy(a.low) - a.start - a.entered) / moved;
    const std::string name = advection == Advection::tvd ? "tvd" : "upwind";
    RecordProperty("step_" + name, fmt::format("{:.3e}", worst));
    RecordProperty("drift_" + name, fmt::format("{:.3e}", drift));
    EXPECT_LT(worst, 1e-10);
    EXPECT_LT(drift, 1e-6);
  }
}

TEST(Inversion, mixing_keeps_the_heat_and_leaves_none) {
  BedParameters p = plain_bed(50, 5, 0.3, 0.01);
  p.initial_temperature = 300;
  PackedBed bed(p, constant_fluid(1800, 1500, 0.5), Filler{}, 1);
  std::vector<double> t(50);
  for (int i = 0; i < 50; ++i) t[i] = 300 + 50 * std::sin(0.7 * i) + i;
  bed.set_temperature(t);
  EXPECT_GT(inversion_of(bed).depth, 10);
  const double before = bed.energy(300);
  bed.mix_inversions();
  EXPECT_NEAR(bed.energy(300), before, 1e-12 * bed.heat_capacity() * 100);
  EXPECT_LT(inversion_of(bed).depth, 1e-9);
}

TEST(Inversion, is_measured_against_the_hottest_fluid_below_however_fine_the_cells) {
  for (const int n : {50, 500}) {
    BedParameters p = plain_bed(n, 5, 0.3, 0.01);
    PackedBed bed(p, constant_fluid(1800, 1500, 0.5), Filler{}, 1);
    std::vector<double> t(n);
    for (int i = 0; i < n; ++i) t[i] = 400 - 100. * i / (n - 1);  // hot at the bottom
    bed.set_temperature(t);
    EXPECT_NEAR(inversion_of(bed).depth, 100, 1e-9) << n;
    std::ranges::reverse(t);
    bed.set_temperature(t);
    EXPECT_EQ(inversion_of(bed).depth, 0) << n;
  }
}

}  // namespace couplet::thermocline::hard_cases_test
