// SPDX-License-Identifier: Apache-2.0
// Ergun's equation: a liquid by hand, a gas whose density changes along the bed against quadrature.
#include "thermocline/bed/packed_bed.hpp"
#include "tests/support/test.hpp"

namespace couplet::thermocline::pressure_loss_test {

Medium water() { return {"water", 1000, 4180, Curve(0.6), Curve(1e-3), 1, 1e4}; }

TEST(Ergun, of_a_liquid_is_that_by_hand) {
  // eps 0.4, d 10 mm, G 20 kg/(m^2 s), mu 1e-3: 150*1e-3*20*0.36/(0.064*1e-4) + 1.75*400*0.6/(0.064*0.01) =
  // 168750 + 656250
  const BedGrid grid({{2, 0.4, 0.01}}, 10);
  const std::vector<double> t(10, 300);
  const PressureLoss loss = pressure_loss(grid, water(), t, 20 * 3.0, 3);
  EXPECT_NEAR(loss.loss(), 2 * 825000. / 1000, 1e-9);
  EXPECT_NEAR(pressure_loss(grid, water(), t, -60, 3).loss(), loss.loss(), 1e-12) << "either way";
  EXPECT_NEAR(pump_power(loss, water(), 300, 60, 0.5), 60 * 1650. / 1000 / 0.5, 1e-9);
  EXPECT_EQ(pressure_loss(grid, water(), t, 0, 3).loss(), 0);
}

TEST(Ergun, of_a_gas_agrees_with_quadrature_along_the_bed) {
  // Two layers, a smooth front from 300 to 900 K, pressures that fall by a fifth: the density changes
  // fourfold.
  const std::vector<BedLayer> layers{{2, 0.35, 0.004}, {4, 0.42, 0.02}};
  const Medium air = air_at(101325, 600);
  const double flux = 0.9, area = 10;
  const auto temperature = [](double z) { return 600 + 300 * std::tanh(1.5 * (z - 3)); };
  const BedGrid grid(layers, 4000);
  std::vector<double> t;
  for (const double z : grid.z) t.push_back(temperature(z));
  const PressureLoss got = pressure_loss(grid, air, t, -flux * area, area);
  // dp/dz = R T (...)/p from the outlet at z = 0 upwards, Runge-Kutta of fourth order with steps of 0.1 mm.
  double p = air.pressure;
  const auto slope = [&](double z, double q) {
    return air.gas_constant * temperature(z) *
           ergun(layers[z < 2 ? 0 : 1], air.viscosity(temperature(z)), flux) / q;
  };
  const int n = 60000;
  const double h = 6. / n;
  for (int i = 0; i < n; ++i) {
    // The coefficients jump at z = 2, a node: each step looks at its own layer only.
    const double z = i * h, in = 1e-9;
    const double a = slope(z + in, p), b = slope(z + h / 2, p + h / 2 * a),
                 c = slope(z + h / 2, p + h / 2 * b), d = slope(z + h - in, p + h * c);
    p += h / 6 * (a + 2 * b + 2 * c + d);
  }
  RecordProperty("error", fmt::format("{:.2e}", std::abs(got.loss() / (p - air.pressure) - 1)));
  RecordProperty("loss", std::to_string(got.loss()));
  EXPECT_GT(got.loss(), 0.1 * air.pressure);
  EXPECT_NEAR(got.loss() / (p - air.pressure), 1, 1e-6);
}

TEST(Ergun, fan_work_is_that_of_an_isentropic_compression) {
  const Medium air = air_at(1e5, 600);
  // T2 = T1 (p2/p1)^(R/c)
  const double hotter = 300 * (std::pow(1.2, 287.05 / 1075) - 1);
  EXPECT_NEAR(pump_power({1.2e5, 1e5}, air, 300, 5, 0.8), 5 * 1075 * hotter / 0.8, 1e-6);
  // For a small loss m dp/(rho eta).
  EXPECT_NEAR(pump_power({100010, 1e5}, air, 300, 5, 1), 5 * 10 / (1e5 / 287.05 / 300), 1e-3 * 43);
}

}  // namespace couplet::thermocline::pressure_loss_test
