// SPDX-License-Identifier: Apache-2.0
// Beds at rest, half hot and half cold: the front widens by the conductivity of the bed, to which the grains contribute by contact
// through the fluid and by radiation. Reference: one temperature for fluid and grains, solved here with a conductivity of its own.
#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::hold_test {

const double height = 4, hold = 48 * 3600;

/// Two days without flow, cold below and hot above.
TankParameters half_charged(double cold, double hot, double porosity, double grain) {
  TankParameters p;
  p.diameter = 3;
  p.bed.cells = 200, p.bed.advection = Advection::implicit;
  p.bed.profile_z = {0, 1.99, 2.01, height};
  p.bed.profile_temperature = {kelvin(cold), kelvin(cold), kelvin(hot), kelvin(hot)};
  p.bed.layers = {{height, porosity, grain}};
  return p;
}

/// Tanks of the literature: salt and quartzite (Pacheco et al. 2002), air and basalt (Zavattoni et al. 2014).
TankParameters salt() {
  TankParameters p = half_charged(290, 396, 0.22, 0.015);
  p.filler.density = 2680, p.filler.specific_heat = {"1068"}, p.filler.conductivity = {"5"};
  return p;
}
TankParameters air(double cold = 100, double hot = 650, double grain = 0.03) {
  TankParameters p = half_charged(cold, hot, 0.4, grain);
  p.fluid.type = MediumInput::Type::air;
  p.filler.density = 2680, p.filler.specific_heat = {"1068"}, p.filler.conductivity = {"2.5"};
  return p;
}

/// Distance between 10 and 90 % of the temperature difference.
double width(std::span<const double> z, std::span<const double> t) {
  const auto place = [&](double share) {
    const double at = t.front() + share * (t.back() - t.front());
    std::size_t i = 0;
    while (t[i + 1] < at) ++i;
    return z[i] + (z[i + 1] - z[i]) * (at - t[i]) / (t[i + 1] - t[i]);
  };
  return place(0.9) - place(0.1);
}

struct Held {
  double width = 0, balance = 0;
  std::vector<diagnostics::Finding> neglected;  // that matter
};
Held held(const TankParameters& p) {
  TankRun run(p);
  run.until(hold, 300);
  run.judged.conclude(false);
  const PackedBed& bed = run.model().bed();
  Held found{width(bed.grid().z, bed.fluid()), 0, {}};
  const double cold = p.bed.profile_temperature.front(), hot = p.bed.profile_temperature.back();
  found.balance = std::abs(run.model().bed_imbalance()) / bed.heat_between(cold, hot);
  for (const char* id : {"conduction-through-the-grains", "radiation-between-the-grains"})
    for (const diagnostics::Finding& f : run.found(id))
      if (f.severity != base::Severity::note) found.neglected.push_back(f);
  return found;
}

using Law = std::function<double(double)>;

/// Width by explicit finite volumes of one temperature, with volumetric heat capacity and conductivity by temperature.
double reference(const TankParameters& p, const Law& capacity, const Law& conductivity) {
  const int n = 400;
  const double dz = height / n;
  std::vector<double> z(n), t(n), flux(n + 1, 0.0);
  for (int i = 0; i < n; ++i)
    z[i] = (i + 0.5) * dz,
    t[i] = z[i] < 2 ? p.bed.profile_temperature.front() : p.bed.profile_temperature.back();
  for (double time = 0, dt = 15; time < hold - 1; time += dt) {
    for (int i = 1; i < n; ++i)
      flux[i] = 0.5 * (conductivity(t[i - 1]) + conductivity(t[i])) * (t[i] - t[i - 1]) / dz;
    for (int i = 0; i < n; ++i) t[i] += dt * (flux[i + 1] - flux[i]) / (dz * capacity(t[i]));
  }
  return width(z, t);
}

/// Zehner, Bauer and Schluender as published, away from 0/0: `r` is the conductivity of radiation over that of the fluid.
double bed_conductivity(double eps, double k, double solid, double r) {
  const double b = 1.25 * std::pow((1 - eps) / eps, 10.0 / 9), kappa = solid / k, n = 1 + (r - b) / kappa;
  const double core = 2 / n *
                      (b * (kappa + r - 1) / (n * n * kappa) * std::log((kappa + r) / b) +
                       (b + 1) / (2 * b) * (r - b) - (b - 1) / n);
  return k * ((1 - std::sqrt(1 - eps)) * (1 + eps * r) + std::sqrt(1 - eps) * core);
}
double radiation(double kelvin, double grain, double k) {
  return 4 * 5.67e-8 / (2 / 0.85 - 1) * std::pow(kelvin, 3) * grain / k;
}
double air_by_another_fit(double kelvin) { return 2.334e-3 * std::pow(kelvin, 1.5) / (kelvin + 164.54); }

TEST(Hold, salt_and_quartzite_spread_by_the_conductivity_of_the_bed) {
  const Held found = held(salt());
  RecordProperty("width", fmt::format("{:.3f}", found.width));
  EXPECT_NEAR(found.width, 1.466, 0.005);  // error function with 2.70 W/(m K)
  EXPECT_LT(found.balance, 1e-12);
  EXPECT_TRUE(found.neglected.empty());
  TankParameters fluid_alone = salt();
  fluid_alone.bed.closures.conduction = Conduction::wakao;
  const Held lacking = held(fluid_alone);
  EXPECT_NEAR(lacking.width, 0.25, 0.01);
  ASSERT_EQ(lacking.neglected.size(), 1u);
  EXPECT_EQ(lacking.neglected[0].id, "conduction-through-the-grains");
  EXPECT_NEAR(lacking.neglected[0].share, 0.29, 0.05);
}

TEST(Hold, sand_and_salt_spread_as_the_error_function) {
  TankParameters p = half_charged(290, 310, 0.4, 0.002);  // a narrow range: one conductivity
  const double k = solar_salt().conductivity(kelvin(300)), own = bed_conductivity(0.4, k, 2.2, 0);
  const double capacity = 0.4 * solar_salt().volumetric() + 0.6 * Filler().volumetric(kelvin(300));
  EXPECT_NEAR(held(p).width, 2.5631 * std::sqrt(2 * own * hold / capacity), 0.005);
}

TEST(Hold, rock_and_hot_air_spread_by_radiation_too) {
  const Held found = held(air());
  RecordProperty("width", fmt::format("{:.3f}", found.width));
  EXPECT_NEAR(found.width, 1.315, 0.015);
  EXPECT_TRUE(found.neglected.empty());
  TankParameters dark = air();
  dark.filler.emissivity = 0;
  const Held lacking = held(dark);
  RecordProperty("dark", fmt::format("{:.3f}", lacking.width));
  EXPECT_NEAR(lacking.width, 0.670, 0.012);
  ASSERT_EQ(lacking.neglected.size(), 1u);
  EXPECT_EQ(lacking.neglected[0].id, "radiation-between-the-grains");
}

TEST(Hold, gravel_and_cool_air_do_not_need_radiation) {
  TankParameters p = air(20, 60, 0.001);
  const Held with = held(p);
  p.filler.emissivity = 0;
  const Held without = held(p);
  EXPECT_NEAR(with.width, without.width, 0.02 * with.width);
  EXPECT_TRUE(without.neglected.empty());
}

TEST(Hold, a_stagnant_bed_has_the_conductivity_of_its_source_with_and_without_radiation) {
  Filler rock{2680, 1068, 2.5};
  const Medium gas = air_at(101325, 600);
  for (const auto& [t, dark, bright] :
       {std::tuple{400., 0.27, 0.58}, {650., 0.34, 1.34}, {900., 0.40, 2.17}}) {
    rock.emissivity = 0.85;
    EXPECT_NEAR(stagnant_conductivity(gas, rock, 0.4, 0.03, t), bright, 0.035 * bright);
    rock.emissivity = 0;
    EXPECT_NEAR(stagnant_conductivity(gas, rock, 0.4, 0.03, t), dark, 0.035 * dark);
  }
  // Continuous where the formula is 0/0: kappa + r = B.
  const double b = 1.25 * std::pow(0.6 / 0.4, 10.0 / 9);
  for (const double r : {0., 0.3, 1.5})
    EXPECT_NEAR(zehner_schluender(0.4, (b - r) * 1.00101, r), zehner_schluender(0.4, (b - r) * 0.99899, r),
                4e-3);
}

/// Rock whose conductivity falls and whose specific heat rises with temperature.
TEST(Hold, properties_of_the_grains_follow_the_temperature) {
  TankParameters p = air();
  p.filler.conductivity = {"table(T, 300, 4.5, 600, 2.5, 1000, 1.5)"};
  p.filler.specific_heat = {"table(T, 300, 800, 700, 1150, 1000, 1250)"};
  const Curve k({300, 600, 1000}, {4.5, 2.5, 1.5}), c({300, 700, 1000}, {800, 1150, 1250});
  const double wanted = reference(
      p, [&](double t) { return 0.6 * 2680 * c(t) + 0.4 * 0.6 * 1075; },
      [&](double t) {
        const double gas = air_by_another_fit(t);
        return bed_conductivity(0.4, gas, k(t), radiation(t, 0.03, gas));
      });
  const Held found = held(p);
  RecordProperty("width", fmt::format("{:.3f}", found.width));
  RecordProperty("reference", fmt::format("{:.3f}", wanted));
  EXPECT_NEAR(found.width, wanted, 0.012 * wanted);
  EXPECT_LT(found.balance, 1e-12);
  p.filler.conductivity = {"4.5"}, p.filler.specific_heat = {"800"};
  EXPECT_GT(std::abs(held(p).width - wanted), 0.05 * wanted) << "values of the cold end";
}

/// Tables of two equal values are the constant, for a bed with flow and resolved grains.
TEST(Hold, a_table_of_equal_values_is_the_constant) {
  std::vector<std::vector<double>> ends;
  for (const char* k : {"0.5", "table(T, 300, 0.5, 1000, 0.5)"}) {
    TankParameters p = salt();
    p.filler.conductivity = {k};
    p.flow.type = FlowParameters::Type::schedule;
    p.flow.rows = {{0, -5, kelvin(396), {}, {}}};
    TankRun run(p);
    run.until(3600, 60);
    ends.push_back(temperatures_of(run.model().bed()));
  }
  for (std::size_t i = 0; i < ends[0].size(); ++i) EXPECT_NEAR(ends[0][i], ends[1][i], 1e-8);
}

TEST(Hold, a_restart_with_tables_continues_bit_for_bit) {
  TankParameters p = air();
  p.filler.conductivity = {"table(T, 300, 4.5, 600, 2.5, 1000, 1.5)"};
  p.filler.specific_heat = {"table(T, 300, 800, 700, 1150, 1000, 1250)"};
  p.flow.type = FlowParameters::Type::schedule;
  p.flow.rows = {{0, -0.3, kelvin(650), {}, {}}, {3600, 0.2, kelvin(100), {}, {}}};
  TankRun a(p), b(p);
  a.until(3000, 60);
  b.control->memory = a.control->memory;
  base::from_numbers(base::to_numbers(a.model()), b.tank, "temperatures");
  b.tank.resume();
  b.time = a.time;
  a.until(7200, 60), b.until(7200, 60);
  EXPECT_EQ(base::to_numbers(a.model()), base::to_numbers(b.model()));
  EXPECT_LT(std::abs(a.model().bed_imbalance()), 1e-11 * a.model().ledger().turnover);
}

TEST(Hold, tvd_refuses_properties_of_temperature) {
  TankParameters p = salt();
  p.bed.advection = Advection::tvd;
  p.filler.conductivity = {"table(T, 300, 5, 1000, 4)"};
  EXPECT_THAT(support::error_of([&] {
                const TankSetup setup(p);
                PackedBed(p.bed, setup.fluid, setup.filler, 3);
              }),
              ::testing::HasSubstr("properties of the filler that depend on temperature"));
}

}  // namespace couplet::thermocline::hold_test
