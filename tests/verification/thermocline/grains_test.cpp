// SPDX-License-Identifier: Apache-2.0
// A grain that cools in fluid of fixed temperature: the series 1 - zeta cot zeta = Bi.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::grains_test {
namespace {

struct Sphere {
  double error = 0;     // of the mean, of the initial difference
  double relative = 0;  // of the mean, of its own value, while it is above 5 %
};

Sphere cool(double biot, int shells, double dt_fourier, double first_fourier) {
  const double diameter = 0.05, radius = diameter / 2;
  const Filler filler;
  const double diffusivity = filler.conductivity / filler.volumetric();
  BedParameters p = plain_bed(1, 1, 0.4, diameter);
  p.closures.film_coefficient = biot * filler.conductivity / radius;
  p.shells = shells;
  p.advection = Advection::tvd;  // its time scheme is of second order
  p.initial_temperature = 300;
  PackedBed bed(p, constant_fluid(1e12, 1e6, 0.5), filler, 1);  // a fluid that never warms
  const std::vector<double> cold(1, 300);
  std::vector<double> state = base::to_numbers(bed);
  for (int j = 1; j <= shells; ++j) state[std::size_t(j)] = 400;
  base::from_numbers(state, bed, "bed");
  bed.resume();
  const auto table = read_columns("sphere_biot.csv");
  Sphere result;
  double reached = 0;
  std::vector<double> mean;
  for (std::size_t i = 0; i < table.at("Bi").size(); ++i) {
    if (table.at("Bi")[i] != biot) continue;
    const double fourier = table.at("Fo")[i];
    run(bed, (fourier - reached) * radius * radius / diffusivity, 0, 300,
        dt_fourier * radius * radius / diffusivity);
    reached = fourier;
    if (fourier < first_fourier) continue;
    bed.filler_temperature(mean);
    const double wanted = table.at("theta_mean")[i], got = (mean[0] - 300) / 100;
    result.error = std::max(result.error, std::abs(got - wanted));
    if (wanted > 0.05) result.relative = std::max(result.relative, std::abs(got / wanted - 1));
  }
  return result;
}

class Grain : public ::testing::TestWithParam<double> {};

TEST_P(Grain, mean_temperature_is_within_half_a_percent_of_the_series) {
  const Sphere s = cool(GetParam(), 20, 5e-4, 0);
  RecordProperty("error", std::to_string(s.error));
  RecordProperty("relative", std::to_string(s.relative));
  EXPECT_LT(s.error, 0.005);
  EXPECT_LT(s.relative, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Biot, Grain, ::testing::Values(0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 100.0));

TEST(Grain, five_shells_are_within_two_percent_after_the_first_moments) {
  for (const double biot : {0.1, 1.0, 10.0})
    EXPECT_LT(cool(biot, 5, 1e-3, 0.05).error, 0.02) << "Biot number " << biot;
}

TEST(Grain, one_shell_is_the_linear_driving_force) {
  // Resistance 1/h + d/(10 k) on the surface of the grain.
  const Filler filler;
  const double d = 0.03, h = 70;
  const Grains grains(filler, 0.4, d, 1);
  EXPECT_NEAR(grains.exchange(h), 6 * 0.6 / d / (1 / h + d / (10 * filler.conductivity)),
              1e-9 * grains.exchange(h));
}

TEST(Grain, the_shells_hold_the_heat_of_the_filler) {
  const Filler filler;
  const Grains grains(filler, 0.4, 0.03, 7);
  EXPECT_NEAR(grains.capacity * 7, 0.6 * filler.volumetric(), 1e-6);
}

TEST(Closures, wakao_and_beek_have_the_values_of_their_formulae) {
  // Solar One's mixture at 70 kg/s: 1.67 W/(m K), 37 W/(m^2 K) (independent evaluation).
  ClosureParameters p;
  const Fluid oil = caloria_ht43();
  const double area = 0.25 * 3.14159265358979 * 18.2 * 18.2, g = 70 / area;
  const LayerClosure mixture(p, oil, Filler{}, 0.22, 0.0046);
  const double t = 254 + zero_celsius, k = oil.conductivity(t), mu = oil.viscosity(t), re = g * 0.0046 / mu;
  const Closure c = mixture.at(t, MassFlux(g));
  const double pr = mu * oil.specific_heat / k;
  EXPECT_NEAR(c.film, (2 + 1.1 * std::cbrt(pr) * std::pow(re, 0.6)) * k / 0.0046, 1e-3 * c.film);
  EXPECT_NEAR(c.conductivity, 0.7 * 0.22 * k + 0.5 * re * pr * k, 1e-3);
  EXPECT_NEAR(c.conductivity, 1.67, 0.02);
  // The wall: Beek's correlation at a fast flow, the stagnant bed at this one.
  const double fast = 20, re_pr = fast * 0.0046 / mu * pr;
  const double beek =
      k / 0.0046 * (0.203 * std::cbrt(re_pr) + 0.220 * std::pow(re_pr / pr, 0.8) * std::pow(pr, 0.4));
  EXPECT_NEAR(mixture.at(t, MassFlux(fast)).wall, beek, 1e-3 * beek);
  EXPECT_NEAR(c.wall, 2 * zehner_schluender(0.22, 2.2 / k) * k / 0.0046, 1e-3 * c.wall);
}

TEST(Closures, wakao_and_kaguei_are_those_of_the_paper) {
  // By hand: Re = 32, Pr = 8: Re^0.6 = 2^3, Pr^(1/3) = 2, Nu = 2 + 1.1 * 2 * 8 = 19.6, and 2 at rest. A fluid with these
  // numbers, k = 0.5, d = 0.02: h = 19.6 * 0.5/0.02.
  const Fluid fluid{"fluid", 1000, 4000, Table(0.5), Table(1e-3), 1, 1e4};  // Pr = 8
  const LayerClosure layer({}, fluid, Filler{}, 0.4, 0.02);
  EXPECT_NEAR(layer.at(350, MassFlux(1.6)).film, 490, 1e-9);  // Re = 1.6 * 0.02/1e-3
  EXPECT_NEAR(layer.at(350, MassFlux(0)).film, 50, 1e-9);
}

// A run that leaves the limits of its fluid is warned about and goes on: the properties follow it for 100 K above and 50 K below.
TEST(Closures, follow_the_fluid_a_little_beyond_its_limits) {
  const Fluid fluid{"fluid", 1000, 4000, Table({200, 1200}, {0.2, 1.2}), Table(1e-3), 400, 700};
  const LayerClosure layer({}, fluid, Filler{}, 0.4, 0.02);
  for (const double t : {355., 390., 550., 710., 795.})  // still: Nu = 2, k = t / 1000
    EXPECT_NEAR(layer.at(t, MassFlux(0)).film, 2 * t / 1000 / 0.02, 1e-9) << t;
}

TEST(Closures, a_stagnant_bed_of_like_materials_conducts_as_they_do) {
  EXPECT_NEAR(zehner_schluender(0.4, 1), 1, 1e-12);
  // Continuous where the formula is 0/0.
  const double b = 1.25 * std::pow(0.6 / 0.4, 10.0 / 9);
  EXPECT_NEAR(zehner_schluender(0.4, b * 1.00101), zehner_schluender(0.4, b * 1.00099), 1e-4);
}

// Zehner and Schluender's formula evaluated by hand, of beds for which B differs: B = 1.9617, 1.25, 0.7966.
TEST(Closures, a_stagnant_bed_conducts_as_the_formula_of_its_porosity) {
  EXPECT_NEAR(zehner_schluender(0.4, 10), 3.64273, 1e-5);
  EXPECT_NEAR(zehner_schluender(0.5, 100), 6.28307, 1e-5);
  EXPECT_NEAR(zehner_schluender(0.6, 30), 3.30343, 1e-5);
}

TEST(Properties, solar_salt_has_the_values_of_its_source) {
  const Fluid salt = solar_salt();
  EXPECT_NEAR(salt.viscosity(290 + zero_celsius), 3.50e-3, 1e-5);
  EXPECT_NEAR(salt.viscosity(340 + zero_celsius), 2.49e-3, 1e-5);
  EXPECT_NEAR(salt.viscosity(390 + zero_celsius), 1.86e-3, 1e-5);
  EXPECT_NEAR(salt.viscosity(565 + zero_celsius), 1.14e-3, 1e-5);
  EXPECT_NEAR(salt.conductivity(340 + zero_celsius), 0.5076, 1e-4);
}

}  // namespace
}  // namespace couplet::thermocline::grains_test
