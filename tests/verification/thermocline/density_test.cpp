// SPDX-License-Identifier: Apache-2.0
// A density that follows the temperature: heat in the pores, weight on the wall, books, checkpoints.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/thermocline/support.hpp"
#include "tests/verification/thermocline/tank_case.hpp"

namespace couplet::thermocline::density_test {
namespace {

const double c0 = zero_celsius;

Fluid real(Fluid fluid) {
  fluid.real_density = true;
  return fluid;
}

TEST(RealDensity, of_the_salt_is_the_constant_of_the_table_at_340_degc_and_of_the_oil_at_280) {
  EXPECT_NEAR(solar_salt().real->at(340 + c0), solar_salt().density, 0.1);
  EXPECT_NEAR(caloria_ht43().real->at(280 + c0), caloria_ht43().density, 3);
  EXPECT_EQ(solar_salt().density_at(500 + c0), solar_salt().density);  // not asked for
}

/// Q = h S [eps c (2090 dT - 0.318 d(T^2)) + (1 - eps) rho_s c_s dT], by hand, from 290 to 565 degC.
TEST(RealDensity, a_bed_that_warms_through_has_taken_the_integral_of_its_capacity) {
  BedParameters p = plain_bed(100, 10, 0.22, 0.005);
  p.initial_temperature = 290 + c0;
  const Fluid salt = real(solar_salt());
  const Filler filler;
  for (const Advection advection : {Advection::upwind, Advection::tvd, Advection::implicit}) {
    p.advection = advection;
    PackedBed bed(p, salt, filler, 20);
    const double wanted =
        bed.area() * 10 *
        (0.22 * 1501.5 * (2090 * 275 - 0.318 * (565.0 * 565 - 290 * 290)) + 0.78 * filler.volumetric() * 275);
    EXPECT_NEAR(bed.heat_between(290 + c0, 565 + c0), wanted, 1e-12 * wanted);
    double entered = 0;
    for (int block = 0; block < 1200; ++block) {
      bed.prepare(std::min(10.0, bed.largest_step(-120)), -120);
      for (double t = 0; t < 60; t += bed.prepared().dt) entered += bed.step(-120, 565 + c0).by_flow;
      bed.settle();
      ASSERT_LE(*std::max_element(bed.fluid().begin(), bed.fluid().end()), 565 + c0 + 0.01);
    }
    ASSERT_NEAR(bed.bottom(), 565 + c0, 1e-3);
    EXPECT_NEAR(entered, wanted, 1e-6 * wanted);
    EXPECT_NEAR(bed.energy(290 + c0), entered, 1e-11 * wanted);
  }
}

TEST(RealDensity, presses_with_the_weight_of_what_lies_above) {
  const BedGrid bed({{10, 0.22, 0.005}}, 100);
  ShellParameters shell;
  shell.plates = {{10, 0.02}};
  const Rings rings(shell, bed, 18, 0);
  std::vector<double> temperature(100, 290 + c0);
  std::fill(temperature.begin() + 50, temperature.end(), 565 + c0);
  const Filler filler;
  const InnerPressure p = inner_pressure(rings, bed, real(solar_salt()), filler, 0, temperature);
  const double hot = 2090 - 0.636 * 565, cold = 2090 - 0.636 * 290;
  EXPECT_NEAR(p.fluid[0], gravity * (5 * hot + 4.95 * cold), 1e-9 * p.fluid[0]);
  EXPECT_NEAR(p.vertical[0], 0.78 * gravity * (5 * (filler.density - hot) + 4.95 * (filler.density - cold)),
              1e-9 * p.vertical[0]);
}

TEST(RealDensity, closes_the_books_of_the_whole_tank_and_goes_on_from_its_state_bit_for_bit) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 100;
  p.fluid.real_density = true;
  TankRun a(p), b(p);
  a.until(30 * 3600, 900);
  const double moved = a.model().ledger().turnover;
  EXPECT_LT(std::abs(a.model().bed_imbalance()), 1e-10 * moved);
  EXPECT_LT(std::abs(a.model().imbalance(a.time)), 1e-6 * moved);
  b.control->memory = a.control->memory;
  base::from_numbers(base::to_numbers(a.model()), b.tank, "temperatures");
  b.tank.resume();
  b.time = a.time;
  a.until(40 * 3600, 900), b.until(40 * 3600, 900);
  EXPECT_EQ(base::to_numbers(a.model()), base::to_numbers(b.model()));
}

/// The oil is heavier where it is cold: the same tank, charged and discharged, stands under another pressure.
TEST(RealDensity, changes_the_stress_and_only_if_asked) {
  TankParameters p = solar_one_parameters();
  p.bed.cells = 100;
  TankRun constant(p);
  p.fluid.real_density = true;
  TankRun varying(p);
  constant.until(900, 900), varying.until(900, 900);
  const int low = 5;
  const double ratio = varying.model().stress().hoop[low] / constant.model().stress().hoop[low];
  RecordProperty("ratio", fmt::format("{:.4f}", ratio));
  EXPECT_GT(ratio, 1.02);
  EXPECT_LT(ratio, 1.08);
}

}  // namespace
}  // namespace couplet::thermocline::density_test
