// SPDX-License-Identifier: Apache-2.0
// What only conducts: columns (ground, roof), the blanket around the wall, and the gas with its radiation.
#include "thermocline/wall/layers.hpp"
#include "tests/support/test.hpp"
#include "thermocline/wall/surroundings.hpp"

namespace couplet::thermocline::layers_test {

const double none = 0, given = std::numeric_limits<double>::infinity();
const Insulator soil{2050, 1840, 1.2};

/// Largest error of a column at 300 K whose inner surface goes to 400 K, against erfc(x/(2 sqrt(a t))), while
/// the far side feels nothing.
double semi_infinite(int cells, int steps) {
  Column column({{soil, 9, cells}}, 1);
  column.set_steady(300, 300);
  const double time = 30 * 86400, diffusivity = 1.2 / (2050 * 1840.0);
  for (int i = 0; i < steps; ++i) column.step(time / steps, Film{given, 400}, Film{none, 0});
  double worst = 0;
  for (std::size_t i = 0; i < column.centre().size(); ++i) {
    const double wanted = std::erfc(column.centre()[i] / (2 * std::sqrt(diffusivity * time)));
    worst = std::max(worst, std::abs((column.temperature()[i] - 300) / 100 - wanted));
  }
  return worst;
}

TEST(Ground, step_change_follows_erfc) {
  const double error = semi_infinite(180, 720);
  RecordProperty("error", std::to_string(error));
  EXPECT_LT(error, 0.005);
}

TEST(Ground, is_second_order_in_space_and_first_in_time) {
  // A quarter of the step with half the cell.
  EXPECT_NEAR(std::log2(semi_infinite(60, 180) / semi_infinite(120, 720)), 2, 0.4);
}

TEST(Slab, cools_as_its_series) {
  // Both surfaces at 300 K from 400 K: theta = sum 4/((2n+1) pi) sin((2n+1) pi x/L) exp(-((2n+1) pi)^2 Fo).
  const double length = 0.4;
  Column column({{soil, length, 80}}, 1);
  column.set_steady(400, 400);
  const double diffusivity = 1.2 / (2050 * 1840.0), fourier = 0.05,
               time = fourier * length * length / diffusivity;
  for (int i = 0; i < 2000; ++i) column.step(time / 2000, Film{given, 300}, Film{given, 300});
  double worst = 0;
  for (std::size_t i = 0; i < column.centre().size(); ++i) {
    double wanted = 0;
    for (int n = 0; n < 40; ++n) {
      const double m = (2 * n + 1) * std::numbers::pi;
      wanted += 4 / m * std::sin(m * column.centre()[i] / length) * std::exp(-m * m * fourier);
    }
    worst = std::max(worst, std::abs((column.temperature()[i] - 300) / 100 - wanted));
  }
  RecordProperty("error", std::to_string(worst));
  EXPECT_LT(worst, 0.005);
}

TEST(Slab, two_layers_pass_the_heat_of_resistances_in_series) {
  const Insulator wool = mineral_wool(), constant{100, 840, 0.05};
  Column column({{constant, 0.1, 7}, {soil, 0.5, 9}}, 3);
  column.set_steady(300, 300);
  Column::ColumnHeat heat;
  for (int i = 0; i < 400; ++i) heat = column.step(1e6, Film{25, 500}, Film{10, 290});
  const double wanted = 3 * (500 - 290) / (1 / 25.0 + 0.1 / 0.05 + 0.5 / 1.2 + 1 / 10.0);
  EXPECT_NEAR(heat.inner / 1e6, wanted, 1e-9 * wanted);
  EXPECT_NEAR(heat.outer / 1e6, wanted, 1e-9 * wanted);
  EXPECT_NEAR(column.outer_surface(Film{10, 290}), 290 + wanted / 3 / 10, 1e-9);
  EXPECT_NEAR(wool.conductivity(323.15), 0.040, 1e-12);
}

TEST(MineralWool, conducts_as_its_table_says_and_linearly_between) {
  const Insulator wool = mineral_wool();
  const double known[] = {0.040, 0.047, 0.066, 0.091, 0.123, 0.163};  // at 50, 100, 200 ... 500 degC
  EXPECT_NEAR(wool.conductivity(kelvin(50)), known[0], 1e-12);
  for (int i = 1; i < 6; ++i) {
    EXPECT_NEAR(wool.conductivity(kelvin(100 * i)), known[i], 1e-12);
    if (i > 1) {
      EXPECT_NEAR(wool.conductivity(kelvin(100 * i - 50)), 0.5 * (known[i - 1] + known[i]), 1e-12);
    }
  }
}

TEST(Slab, a_steady_start_is_linear_in_the_resistance_passed) {
  const Insulator brick{2000, 800, 1.2}, sand{1500, 800, 0.3};
  Column column({{brick, 0.4, 4}, {sand, 0.2, 3}}, 2);
  column.set_steady(600, 300);
  const double whole = 0.4 / 1.2 + 0.2 / 0.3;
  for (int i = 0; i < 7; ++i) {
    const double passed = i < 4 ? 0.1 * (i + 0.5) / 1.2 : 0.4 / 1.2 + 0.2 / 3 * (i - 4 + 0.5) / 0.3;
    EXPECT_NEAR(column.temperature()[i], 600 - 300 * passed / whole, 1e-9) << i;
  }
}

TEST(Slab, keeps_its_books) {
  Column column({{mineral_wool(), 0.3, 10}}, 2);
  column.set_steady(600, 300);
  const double before = column.energy(300);
  double in = 0;
  for (int i = 0; i < 100; ++i) {
    const auto heat = column.step(500, Film{30, 600 + 50 * std::sin(0.1 * i)}, Film{8, 290});
    in += heat.inner - heat.outer;
  }
  EXPECT_NEAR(column.energy(300) - before, in, 1e-9 * std::abs(before));
}

TEST(Blanket, steady_loss_is_that_of_a_hollow_cylinder) {
  InsulationParameters p;
  p.material.conductivity = {0.06};
  p.thickness = 0.3;
  p.cells = 6;
  const double radius = 9.1;
  const std::vector<double> dz{0.5, 0.7};
  Insulation blanket(p, dz, radius);
  const std::vector<double> inside{550, 600};
  const Film outside{12, 290};
  std::vector<double> given_by(2);
  double lost = 0;
  for (int i = 0; i < 300; ++i) lost = blanket.step(1e5, inside, outside, given_by) / 1e5;
  double wanted = 0;
  for (int i = 0; i < 2; ++i) {
    const double resistance = std::log((radius + 0.3) / radius) / (2 * std::numbers::pi * 0.06) +
                              1 / (2 * std::numbers::pi * (radius + 0.3) * 12);
    wanted += dz[i] * (inside[i] - 290) / resistance;
    EXPECT_NEAR(given_by[i], dz[i] * (inside[i] - 290) / resistance, 1e-6 * wanted);
  }
  EXPECT_NEAR(lost, wanted, 1e-6 * wanted);
}

TEST(Blanket, steady_start_stays) {
  InsulationParameters p;
  p.thickness = 0.4;
  const std::vector<double> dz{0.5}, inside{650};
  Insulation blanket(p, dz, 20);
  blanket.set_steady(inside, 300);
  std::vector<double> q(1);
  const double first = blanket.step(300, inside, Film{1e9, 300}, q);
  double later = 0;
  for (int i = 0; i < 1000; ++i) later = blanket.step(300, inside, Film{1e9, 300}, q);
  EXPECT_NEAR(first, later, 2e-3 * later);
}

TEST(Enclosure, view_factors_and_two_parallel_discs) {
  // Discs much closer than wide: eps_1 eps_2 sigma (T1^4 - T2^4)/(eps_1 + eps_2 - eps_1 eps_2).
  const Enclosure close(100, 0.01);
  const double area = std::numbers::pi * 1e4;
  EXPECT_NEAR(close.exchange[0][1], -area / (1 / 0.95 + 1 / 0.8 - 1), 2e-3 * area);
  // X = 1 + (H/R)^2/2 for equal radii; H = R: F = 0.381966.
  EXPECT_NEAR(Enclosure(1, 1).disc_to_disc, 0.381966, 1e-6);
}

TEST(Ullage, what_enters_leaves_and_equal_temperatures_exchange_nothing) {
  Ullage gas(0, 20, 1);
  gas.set_gas(500);
  const Ullage::UllageHeat still = gas.step(60, 500, 500, 500, 1000, 101325);
  EXPECT_NEAR(still.from_liquid, 0, 1e-3);
  EXPECT_NEAR(still.into_roof, 0, 1e-3);
  double before = gas.energy(300);
  const Ullage::UllageHeat heat = gas.step(60, 560, 540, 400, 2000, 101325);
  EXPECT_NEAR(heat.from_liquid + heat.from_wall - heat.into_roof, (gas.energy(300) - before) / 60,
              1e-9 * heat.into_roof);
  EXPECT_GT(heat.into_roof, 0);
  EXPECT_GT(heat.roof_surface, 400);
  EXPECT_LT(heat.roof_surface, 560);
}

// Nu = 0.069 Ra^(1/3) Pr^0.074 between liquid and roof, in two films; nothing moves below a warmer one.
TEST(Ullage, convection_below_a_roof_is_that_of_globe_and_dropkin) {
  constexpr std::array<double, 3> dull{1e-7, 1e-7, 1e-7};
  const double area = std::numbers::pi * 100, height = 1.5;
  for (const double roof : {440., 560.}) {
    Ullage gas(0, 20, height, dull);
    gas.set_gas(500);
    const Ullage::UllageHeat heat = gas.step(1e9, 520, 490, roof, 1e7, 101325);
    const Air air(0.5 * (520 + heat.roof_surface), 101325);
    const double ra = heat.roof_surface < 520 ? air.rayleigh(520 - heat.roof_surface, height) : 0;
    const double nu = std::max(1.0, 0.069 * std::cbrt(ra) * std::pow(air.prandtl, 0.074));
    const double film = 2 * area * nu * air.conductivity / height;
    EXPECT_NEAR(heat.into_roof / (film * (gas.gas_temperature() - heat.roof_surface)), 1, 1e-3) << roof;
    EXPECT_NEAR(heat.from_liquid / (film * (520 - gas.gas_temperature())), 1, 1e-3) << roof;
  }
}

TEST(Environment, correlations_have_the_values_of_their_formulae) {
  const Air air(300, 101325);
  EXPECT_NEAR(air.conductivity, 0.0263, 2e-4);  // Incropera table A.4
  EXPECT_NEAR(air.viscosity, 184.6e-7, 2e-7);
  EXPECT_NEAR(air.density, 1.1614, 0.016);
  EXPECT_NEAR(vertical_plate_nusselt(1e9, 0.7), 123.4, 1.5);
  EXPECT_NEAR(sky_temperature(293.15), 277.1, 0.1);
  Ambient windy;
  windy.wind = 6;
  const double calm = side_film(300, 20, 12, Ambient{}).coefficient;
  EXPECT_GT(side_film(300, 20, 12, windy).coefficient, 2 * calm);
}

}  // namespace couplet::thermocline::layers_test
