// SPDX-License-Identifier: Apache-2.0
// The packed bed against closed forms: Schumann 1929 (fluid and grains of one temperature each, no
// conduction), Ogata and Banks 1961 (one phase, advection and conduction), and the late front, whose width is
// that of all resistances together.
#include "tests/verification/thermocline/support.hpp"

namespace couplet::thermocline::bed_test {

/// The bed of the Schumann problem: xi = 20 at its top for a mass flux of 1 kg/(m^2 s).
struct Schumann {
  double flux = 1, height = 5, porosity = 0.4, diameter = 0.02;
  Medium fluid = constant_fluid(1800, 1500, 0.5);
  Filler filler{2500, 900, 1e7};  // no resistance inside the grains
  double h_v = 20 * flux * fluid.specific_heat / height;

  PackedBed make(int cells, Advection advection, double courant) const {
    BedParameters p = plain_bed(cells, height, porosity, diameter);
    p.closures.film_coefficient = h_v * diameter / (6 * (1 - porosity));
    p.shells = 1;
    p.advection = advection;
    p.courant = courant;
    p.initial_temperature = 300;
    return PackedBed(p, fluid, filler, 2 / std::sqrt(3.14159265358979));  // area 1 m^2
  }
  double z(double xi) const { return xi * flux * fluid.specific_heat / h_v; }
  double time(double xi, double eta) const {
    return eta * (1 - porosity) * filler.volumetric(300) / h_v + porosity * fluid.density * z(xi) / flux;
  }
  /// Largest error of fluid and grains over the points of the table inside the bed, xi from `first` on.
  double error(int cells, Advection advection, double courant, double first, double longest = 1e300) const {
    const auto table = read_columns("schumann.csv");
    double worst = 0;
    for (std::size_t i = 0; i < table.at("xi").size(); ++i) {
      const double xi = table.at("xi")[i], eta = table.at("eta")[i];
      if (xi < first || xi > 10) continue;
      PackedBed bed = make(cells, advection, courant);
      run(bed, time(xi, eta), flux * bed.area(), 400, longest);
      std::vector<double> grains;
      bed.filler_temperature(grains);
      const double f = (value_at(bed.grid(), bed.fluid(), z(xi)) - 300) / 100;
      const double s = (value_at(bed.grid(), grains, z(xi)) - 300) / 100;
      worst = std::max({worst, std::abs(f - table.at("theta_f")[i]), std::abs(s - table.at("theta_s")[i])});
    }
    return worst;
  }
};

TEST(Schumann, fine_tvd_grid_is_within_half_a_percent) {
  const double error = Schumann().error(1600, Advection::tvd, 0.5, 1);
  RecordProperty("error", std::to_string(error));
  EXPECT_LT(error, 0.005);
}

/// Schumann's fluid temperature at xi for an inlet that rises smoothly as sin^2 over `rise`: the step
/// response (theta_s = int_0^eta exp(-xi - s) I0(2 sqrt(xi s)) ds, theta_f = theta_s + exp(-xi - eta) I0(2
/// sqrt(xi eta))) folded with the inlet's rate.
class SmoothInlet {
 public:
  SmoothInlet(const Schumann& problem, double rise) : problem_(problem), rise_(rise) {}
  double inlet(double t) const {
    return t >= rise_ ? 1 : std::pow(std::sin(0.5 * std::numbers::pi * t / rise_), 2);
  }
  double at(double xi, double time) const {
    const double transit = problem_.time(xi, 0), per_second = 1 / (problem_.time(xi, 1) - transit);
    const double last = std::min(rise_, time - transit);
    if (last <= 0) return 0;
    const int n = 4000;
    std::vector<double> solid(n + 1, 0.0), kernel(n + 1);
    const double width = (time - transit) * per_second / n;
    for (int k = 0; k <= n; ++k) {
      kernel[k] = std::exp(-xi - k * width) * std::cyl_bessel_i(0, 2 * std::sqrt(xi * k * width));
      if (k > 0) solid[k] = solid[k - 1] + 0.5 * width * (kernel[k] + kernel[k - 1]);
    }
    double sum = 0;
    for (int k = 0; k < n; ++k) {  // midpoints of the inlet's history
      const double t = (k + 0.5) * last / n;
      const double rate = 0.5 * std::numbers::pi / rise_ * std::sin(std::numbers::pi * t / rise_);
      const double place = (time - transit - t) * per_second / width;
      const int i = std::min(n - 1, int(place));
      const double w = place - i;
      sum += rate * ((1 - w) * (solid[i] + kernel[i]) + w * (solid[i + 1] + kernel[i + 1]));
    }
    return sum * last / n;
  }

 private:
  const Schumann& problem_;
  double rise_;
};

TEST(Schumann, tvd_is_second_order) {
  const Schumann problem;
  const double time = problem.time(10, 10);
  const SmoothInlet smooth(problem, problem.time(0, 6));
  const auto error = [&](int cells) {
    PackedBed bed = problem.make(cells, Advection::tvd, 0.5);
    const double flow = problem.flux * bed.area();
    const int n = int(std::ceil(time / bed.largest_step(flow)));
    bed.prepare(time / n, flow);
    for (int i = 0; i < n; ++i) bed.step(flow, 300 + 100 * smooth.inlet((i + 0.5) * time / n));
    double worst = 0;
    for (const double xi : {1.0, 2.0, 5.0, 8.0, 10.0, 12.0, 15.0, 18.0}) {
      const double got = (value_at(bed.grid(), bed.fluid(), problem.z(xi)) - 300) / 100;
      worst = std::max(worst, std::abs(got - smooth.at(xi, time)));
    }
    return worst;
  };
  const double coarse = error(100), medium = error(200), fine = error(400);
  RecordProperty("slope", std::to_string(slope(medium, fine)));
  RecordProperty("slope_coarse", std::to_string(slope(coarse, medium)));
  RecordProperty("fine", fmt::format("{:.2e}", fine));
  EXPECT_GT(slope(medium, fine), 1.8);
}

TEST(Schumann, air_through_rock_is_within_half_a_percent) {
  // The gas crosses a cell in a hundredth of a second; the implicit scheme takes steps of seconds.
  Schumann gas;
  gas.fluid = constant_fluid(0.6, 1075, 0.045);
  gas.filler = {2600, 900, 1e7};
  gas.flux = 0.4, gas.diameter = 0.03;
  gas.h_v = 20 * gas.flux * gas.fluid.specific_heat / gas.height;
  const double error = gas.error(4000, Advection::implicit, 0.5, 1, gas.time(0, 1) / 400);
  RecordProperty("error", std::to_string(error));
  EXPECT_LT(error, 0.005);
}

TEST(Schumann, a_step_at_the_inlet_costs_half_an_order) {
  const Schumann problem;
  const double medium = problem.error(200, Advection::tvd, 0.5, 5),
               fine = problem.error(400, Advection::tvd, 0.5, 5);
  RecordProperty("slope", std::to_string(slope(medium, fine)));
  EXPECT_GT(slope(medium, fine), 1.4);
}

TEST(Schumann, upwind_is_first_order) {
  const Schumann problem;
  const double medium = problem.error(400, Advection::upwind, 0.5, 5),
               fine = problem.error(800, Advection::upwind, 0.5, 5);
  EXPECT_NEAR(slope(medium, fine), 1, 0.15);
}

TEST(Schumann, downward_flow_is_the_mirror_of_upward_flow) {
  const Schumann problem;
  for (const Advection advection : {Advection::upwind, Advection::tvd, Advection::implicit}) {
    PackedBed up = problem.make(50, advection, 0.5), down = problem.make(50, advection, 0.5);
    run(up, 3000, 0.7, 400, 30);
    run(down, 3000, -0.7, 400, 30);
    for (int i = 0; i < 50; ++i) EXPECT_NEAR(up.fluid()[i], down.fluid()[49 - i], 1e-9);
  }
}

struct OgataBanks {
  /// Largest error over the table's points of this Peclet number, in a bed of fluid alone, 3 m high.
  static double error(double peclet, int cells, Advection advection) {
    const double velocity = 1e-3, density = 1000, heat = 4000;
    const double conductivity = velocity / peclet * density * heat;
    const auto table = read_columns("ogata_banks.csv");
    double worst = 0;
    for (const double star : {0.25, 0.5, 0.75, 1.0}) {
      BedParameters p = plain_bed(cells, 3, 1, 0.01);
      p.closures.conductivity = conductivity;
      p.conducting_inlet = true;
      p.advection = advection;
      p.shells = 1;
      p.initial_temperature = 300;
      PackedBed bed(p, constant_fluid(density, heat, 0.5), Filler{}, 1);
      run(bed, star / velocity, velocity * density * bed.area(), 400);
      for (std::size_t i = 0; i < table.at("Pe").size(); ++i) {
        if (table.at("Pe")[i] != peclet || std::abs(table.at("t_star")[i] - star) > 1e-9) continue;
        const double x = table.at("x_star")[i];
        if (x < 3.0 / cells) continue;  // the inlet itself
        worst = std::max(worst,
                         std::abs((value_at(bed.grid(), bed.fluid(), x) - 300) / 100 - table.at("theta")[i]));
      }
    }
    return worst;
  }
};

TEST(Tvd, a_linear_profile_enters_as_it_is) {
  // Half a cell lies between the inlet and the first centre: with the slope of a whole cell the first cells
  // would be off by a tenth of a cell's difference. A short step keeps the inlet's own change out of it.
  for (const double way : {1.0, -1.0}) {
    BedParameters p = plain_bed(40, 4, 1, 0.01);
    p.shells = 1;
    p.advection = Advection::tvd;
    p.courant = 5e-3;
    PackedBed bed(p, constant_fluid(1000, 4000, 0.5), Filler{}, 1);
    const double velocity = 1e-3, slope = 10, flow = way * velocity * 1000 * bed.area();
    const auto wanted = [&](double z, double t) { return 300 + slope * (z - way * velocity * t); };
    std::vector<double> start;
    for (const double z : bed.grid().z) start.push_back(wanted(z, 0));
    bed.set_temperature(start);
    const double dt = bed.largest_step(flow);
    bed.prepare(dt, flow);
    const int steps = 2000;  // ten cells
    for (int i = 0; i < steps; ++i) bed.step(flow, wanted(way > 0 ? 0 : 4, (i + 0.5) * dt));
    double worst = 0;
    for (int i = 0; i < 20; ++i) {
      const int cell = way > 0 ? i : 39 - i;
      worst = std::max(worst, std::abs(bed.fluid()[cell] - wanted(bed.grid().z[cell], steps * dt)));
    }
    RecordProperty(way > 0 ? "up" : "down", std::to_string(worst / (slope * 0.1)));
    EXPECT_LT(worst, 0.01 * slope * 0.1);
  }
}

TEST(OgataBanks, front_is_within_half_a_percent) {
  for (const double peclet : {10.0, 100.0}) {
    const double error = OgataBanks::error(peclet, 900, Advection::tvd);
    RecordProperty("error_" + std::to_string(int(peclet)), std::to_string(error));
    EXPECT_LT(error, 0.005) << "Peclet number " << peclet;
  }
}

TEST(OgataBanks, a_smooth_front_is_carried_with_second_order) {
  // Without the jump at the inlet: theta = 0.5 erfc((z - z0 - u t)/sqrt(2 (s0^2 + 2 D t))).
  const double velocity = 1e-3, density = 1000, heat = 4000, diffusivity = 1e-5, s0 = 0.1, time = 1000;
  const auto front = [&](double z, double t) {
    return 0.5 * std::erfc((z - 0.8 - velocity * t) / std::sqrt(2 * (s0 * s0 + 2 * diffusivity * t)));
  };
  const auto error = [&](int cells) {
    BedParameters p = plain_bed(cells, 3, 1, 0.01);
    p.closures.conductivity = diffusivity * density * heat;
    p.advection = Advection::tvd;
    p.shells = 1;
    PackedBed bed(p, constant_fluid(density, heat, 0.5), Filler{}, 1);
    std::vector<double> start(cells);
    for (int i = 0; i < cells; ++i) start[i] = 300 + 100 * front(bed.grid().z[i], 0);
    bed.set_temperature(start);
    run(bed, time, velocity * density * bed.area(), 400);
    double worst = 0;
    for (int i = 0; i < cells; ++i)
      worst = std::max(worst, std::abs((bed.fluid()[i] - 300) / 100 - front(bed.grid().z[i], time)));
    return worst;
  };
  const double coarse = error(150), fine = error(300);
  RecordProperty("slope", std::to_string(slope(coarse, fine)));
  RecordProperty("fine", fmt::format("{:.2e}", fine));
  EXPECT_GT(slope(coarse, fine), 1.8);
}

/// Mean and variance of a rising front, as those of the distribution dT/dz.
std::pair<double, double> moments(const PackedBed& bed) {
  const auto t = bed.fluid();
  const BedGrid& g = bed.grid();
  double weight = 0, mean = 0, square = 0;
  for (int i = 0; i + 1 < g.size(); ++i) {
    const double w = t[i + 1] - t[i], z = g.z[i] + g.dz[i] / 2;
    weight += w, mean += w * z, square += w * z * z;
  }
  mean /= weight;
  return {mean, square / weight - mean * mean};
}

TEST(Front, late_width_grows_by_dispersion_film_and_conduction_in_the_grains_together) {
  // k_tot = k_eff + (G c beta)^2/h_v', 1/h' = 1/h + d/(10 k_s), beta = (1 - eps) rho_s c_s/(rho c)_eff, and
  // the front moves with G c/(rho c)_eff.
  const double flux = 0.3, porosity = 0.22, d = 0.0046, k = 2, film = 30;
  const Medium oil = constant_fluid(692.4, 2700, 0.09);
  const Filler filler;
  BedParameters p = plain_bed(1500, 60, porosity, d);
  p.closures.conductivity = k;
  p.closures.film_coefficient = film;
  p.shells = 4;
  p.advection = Advection::tvd;
  p.initial_temperature = 500;
  PackedBed bed(p, oil, filler, 1);
  const double effective = porosity * oil.volumetric() + (1 - porosity) * filler.volumetric(300);
  const double beta = (1 - porosity) * filler.volumetric(300) / effective;
  const double h = 1 / (1 / film + d / (10 * filler.conductivity(300))), h_v = 6 * (1 - porosity) * h / d;
  const double speed = flux * oil.specific_heat / effective;
  const double total = k + std::pow(flux * oil.specific_heat * beta, 2) / h_v;
  const double start = 5 / speed, later = 20 / speed;
  run(bed, start, flux * bed.area(), 400);
  const auto [mean1, variance1] = moments(bed);
  run(bed, later, flux * bed.area(), 400);
  const auto [mean2, variance2] = moments(bed);
  const double speed_ratio = (mean2 - mean1) / later / speed;
  const double width_ratio = (variance2 - variance1) / later / (2 * total / effective);
  RecordProperty("speed_ratio", std::to_string(speed_ratio));
  RecordProperty("width_ratio", std::to_string(width_ratio));
  EXPECT_NEAR(speed_ratio, 1, 1e-3);
  EXPECT_NEAR(width_ratio, 1, 0.02);
}

TEST(Front, numerical_diffusion_of_upwind_is_that_of_theory) {
  // k_num = G c dz (1 - Courant)/2 for the fluid; through the bed's heat capacity 1 - Courant becomes 1 -
  // Courant eps rho c/(rho c)_eff.
  const double flux = 0.3, porosity = 0.22;
  const Medium oil = constant_fluid(692.4, 2700, 0.09);
  const Filler filler;
  const double effective = porosity * oil.volumetric() + (1 - porosity) * filler.volumetric(300);
  const double speed = flux * oil.specific_heat / effective;
  BedParameters p = plain_bed(1000, 25, porosity, 1e-4);
  p.closures.conductivity = 0;
  p.closures.film_coefficient = 1e4;  // grains follow at once
  p.shells = 1;
  p.courant = 0.28;
  p.initial_temperature = 500;
  PackedBed bed(p, oil, filler, 1);
  run(bed, 4 / speed, flux * bed.area(), 400);
  const double before = moments(bed).second;
  run(bed, 10 / speed, flux * bed.area(), 400);
  const double k = (moments(bed).second - before) / (10 / speed) * effective / 2;
  // The implicit exchange adds the same amount that a first-order step in time always adds.
  const double advected = flux * oil.specific_heat * 0.025 / 2;
  const double in_time = p.courant * porosity * oil.volumetric() / effective;
  RecordProperty("over_theory", std::to_string(k / advected));
  EXPECT_GT(k / advected, 1 - 2 * in_time);
  EXPECT_LT(k / advected, 1 + 2 * in_time);
}

}  // namespace couplet::thermocline::bed_test
