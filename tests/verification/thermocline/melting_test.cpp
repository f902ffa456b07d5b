// SPDX-License-Identifier: Apache-2.0
// Capsules that melt: Stefan's front, the books, and a layer without latent heat as a layer of grains.
#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::melting_test {

/// A resting bed whose tiny capsules follow the fluid: one medium with conductivity k, heated from below.
struct Stefan {
  double k = 2, height = 1, porosity = 0.3, cold = 300, melts = 300, hot = 310, width = 0.001;
  Medium fluid = constant_fluid(1000, 2000, 0.5);
  Filler filler{2000, 1000, 1e6};
  Melting melting{0, 0, 100e3};

  double capacity() const { return porosity * fluid.volumetric() + (1 - porosity) * filler.volumetric(300); }
  double latent() const { return (1 - porosity) * filler.density * melting.latent_heat; }
  double diffusivity() const { return k / capacity(); }
  /// lambda exp(lambda^2) erf(lambda) = Ste/sqrt(pi) [alexiades1993].
  double lambda() const {
    const double stefan = capacity() * (hot - melts) / latent();
    double low = 0, high = 5;
    for (int i = 0; i < 200; ++i) {
      const double x = 0.5 * (low + high);
      (x * std::exp(x * x) * std::erf(x) < stefan / std::sqrt(std::numbers::pi) ? low : high) = x;
    }
    return low;
  }
  PackedBed make(int cells) const {
    BedParameters p = plain_bed(cells, height, porosity, 1e-4);
    p.closures.conductivity = k;
    p.closures.film_coefficient = 1e4;
    p.conducting_inlet = true;
    p.advection = Advection::implicit;
    p.shells = 1;
    p.initial_temperature = cold;
    Melting m = melting;
    m.width = width, m.temperature = melts + width / 2;
    p.layers[0].melting = m;
    return PackedBed(p, fluid, filler, 2 / std::sqrt(std::numbers::pi));
  }
  /// Height of the front from the heat that went in: that of the similarity solution up to X plus what
  /// melted.
  double front(const PackedBed& bed) const {
    const auto t = bed.shell(0);
    const double at = melts + width;  // molten
    int i = 0;
    while (i + 2 < bed.grid().size() && t[i + 1] >= at) ++i;
    const double share = std::clamp((t[i + 1] - melts) / width, 0.0, 1.0);
    return bed.grid().z[i] + bed.grid().dz[i] / 2 + share * bed.grid().dz[i + 1];
  }
  double error(int cells, double time, int steps) const {
    PackedBed bed = make(cells);
    const double flow = 1e-12;  // so that the inlet conducts
    bed.prepare(time / steps, flow);
    for (int i = 0; i < steps; ++i) bed.step(flow, hot);
    const double wanted = 2 * lambda() * std::sqrt(diffusivity() * time);
    return std::abs(front(bed) / wanted - 1);
  }
};

TEST(Melting, stefans_front_is_within_a_percent_and_of_first_order) {
  const Stefan s;
  const double time = std::pow(0.5 / (2 * s.lambda()), 2) / s.diffusivity();  // the front half way up
  const double coarse = s.error(50, time, 500), fine = s.error(200, time, 2000);
  const double order = std::log(coarse / fine) / std::log(4.0);
  RecordProperty("coarse", std::to_string(coarse));
  RecordProperty("fine", std::to_string(fine));
  RecordProperty("order", std::to_string(order));
  RecordProperty("lambda", std::to_string(s.lambda()));
  EXPECT_LT(fine, 0.01);
  EXPECT_GT(order, 1.0);
}

/// A day of charge and discharge through layers that melt above and below a bed of stone.
TEST(Melting, the_books_close_in_every_step) {
  for (const Advection advection : {Advection::upwind, Advection::implicit})
    for (const int shells : {1, 5}) {
      BedParameters p = plain_bed(90, 9, 0.3, 0.01);
      p.closures.conduction = Conduction::wakao;
      p.advection = advection, p.shells = shells;
      p.initial_temperature = kelvin(290);
      const FillerParameters capsule{1900, {"1500"}, {"0.8"}};
      p.layers = {{2, 0.35, 0.02, capsule, Melting{kelvin(300), 4, 150e3}},
                  {5, 0.25, 0.01},
                  {2, 0.35, 0.02, capsule, Melting{kelvin(380), 2, 150e3}}};
      PackedBed bed(p, solar_salt(), Filler{}, 10);
      const double cold = kelvin(290), hot = kelvin(390), start = bed.energy(cold);
      double entered = 0, worst = 0, beyond = 0, filled = 0;
      const double scale = bed.heat_between(cold, hot);
      for (int half = 0; half < 4; ++half) {
        const double flow = half % 2 ? 60 : -60;
        const double longest = std::min(120.0, bed.largest_step(flow));
        bed.prepare(longest, flow);
        for (double t = 0; t < 10 * 3600; t += longest) {
          const double before = bed.energy(cold);
          const auto heat = bed.step(flow, flow < 0 ? hot : cold);
          entered += heat.by_flow;
          worst = std::max(worst, std::abs(bed.energy(cold) - before - heat.by_flow) / scale);
          for (const double value : temperatures_of(bed))
            beyond = std::max({beyond, cold - value, value - hot});
        }
        filled = std::max(filled, bed.energy(cold) / scale);
      }
      RecordProperty("step", fmt::format("{:.2e}", worst));
      EXPECT_LT(worst, 1e-10);
      EXPECT_LT(std::abs(bed.energy(cold) - start - entered) / scale, 1e-9);
      EXPECT_LT(beyond, 1e-6);
      EXPECT_GT(filled, 0.5);
    }
}

TEST(Melting, without_latent_heat_a_capsule_is_a_grain) {
  std::vector<std::vector<double>> ends;
  for (const bool capsules : {false, true}) {
    BedParameters p = plain_bed(60, 6, 0.3, 0.02);
    p.closures.conductivity = 1;
    p.initial_temperature = 300;
    if (capsules) p.layers[0].melting = Melting{350, 10, 0};
    PackedBed bed(p, constant_fluid(1800, 1500, 0.5), Filler{}, 4);
    run(bed, 4000, 10, 400);
    ends.push_back(temperatures_of(bed));
  }
  for (std::size_t i = 0; i < ends[0].size(); ++i) EXPECT_NEAR(ends[0][i], ends[1][i], 1e-9);
}

TEST(Melting, heat_and_temperature_are_inverse) {
  const GrainHeat phase(Filler{1900, 1500, 0.8}, Melting{600, 4, 150e3});
  for (double t = 550; t < 650; t += 0.37) EXPECT_NEAR(phase.temperature(phase.heat(t)), t, 1e-9);
  EXPECT_NEAR(phase.heat(602) - phase.heat(598), 1900 * (1500 * 4 + 150e3), 1e-3);
}

// A density that follows the temperature: heat in the pores, weight on the wall, books, checkpoints.

const double c0 = zero_celsius;

Medium real(Medium fluid) {
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
  const Medium salt = real(solar_salt());
  const Filler filler;
  for (const Advection advection : {Advection::upwind, Advection::tvd, Advection::implicit}) {
    p.advection = advection;
    PackedBed bed(p, salt, filler, 20);
    const double wanted = bed.area() * 10 *
                          (0.22 * 1501.5 * (2090 * 275 - 0.318 * (565.0 * 565 - 290 * 290)) +
                           0.78 * filler.volumetric(300) * 275);
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

}  // namespace couplet::thermocline::melting_test
