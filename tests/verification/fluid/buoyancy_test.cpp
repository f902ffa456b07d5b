// SPDX-License-Identifier: Apache-2.0
// Flows that buoyancy drives, against benchmarks.
#include "heat_case.hpp"
#include "ring_mesh.hpp"

namespace couplet::fluid::test::buoyancy_test {
using namespace mesh;

constexpr double pi = std::numbers::pi;

/// Buoyancy on -y.
void add_buoyancy(FluidParameters& p, double expansion_times_gravity) {
  p.heat->expansion = 1e-3;
  p.heat->gravity = {0, -expansion_times_gravity / p.heat->expansion};
}

/// Pressure balances a temperature that is linear in height exactly where cells are equal.
TEST(Buoyancy, leaves_a_stratified_fluid_at_rest) {
  FluidParameters p = warm(0.01, 0.01, 1e-12);
  add_buoyancy(p, 10);
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymin"] = at(boundary(BoundaryType::no_slip), "300");
  p.boundaries["ymax"] = at(boundary(BoundaryType::no_slip), "310");
  p.heat->initial_temperature.text = "300+10*y";
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {12, 16, 1}, Vec3::Zero(), Vec3::Ones()),
                 p);
  c.run(1, 50);
  const double speed = c.largest_velocity_error([](const Vec3&) { return Vec3(Vec3::Zero()); });
  printf("stratified rest: %.1e m/s\n", speed);
  RecordProperty("speed", std::to_string(speed * 1e9) + "e-9");
  EXPECT_LT(speed, 1e-9);  // free fall would reach 10 m/s
}

/// Flow that a warm side sets in motion, on one mesh by the differences of runs whose steps are halved. With friction explicit and
/// implicit, and on a mesh that moves. There an error of order h^2 dt is left, of oblique cells, which hides the slope on 16 x 16 cells
/// (1.7 of the velocity).
TEST(Buoyancy, is_second_order_in_time) {
  for (const auto& [name, viscous, moves] : {std::tuple{"explicit", ViscousTreatment::explicit_, false},
                                             {"implicit", ViscousTreatment::implicit, false},
                                             {"moving", ViscousTreatment::implicit, true}}) {
    FluidParameters p = warm(0.02, 0.02, 1e-12);
    p.viscous = viscous;
    p.time_step = 1;
    p.heat->initial_temperature.text = "300+cos(pi*x)";
    p.initial_velocity = {{"0.3*sin(pi*x)^2*sin(2*pi*y)"}, {"-0.3*sin(2*pi*x)*sin(pi*y)^2"}};
    add_buoyancy(p, 2);
    all_sides(p, 2, boundary(BoundaryType::no_slip));
    PointMotion motion;
    if (moves)
      motion = [](const Vec3& x, GlobalIndex, double t) {
        const double s = 0.05 * std::sin(pi * x[0]) * std::sin(pi * x[1]) * (1 - std::cos(6 * t));
        return Vec3(x[0] + s, x[1] - 0.7 * s, x[2]);
      };
    std::vector<FluidCase<2>> runs;
    const int n = moves ? 48 : 16;
    for (const int steps : {64, 128, 256}) {
      runs.emplace_back(MPI_COMM_WORLD,
                        make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3::Ones()), p, motion);
      runs.back().run(0.8, steps);
    }
    const auto apart = [](const FluidCase<2>& a, const FluidCase<2>& b) {
      double square = 0;
      for (Index c = 0; c < a.mesh().cells.n_owned(); ++c)
        square += std::pow(a.state().heat.temperature[c] - b.state().heat.temperature[c], 2);
      return std::sqrt(square);
    };
    const double velocity = std::log2(difference(runs[0], runs[1]) / difference(runs[1], runs[2])),
                 temperature = std::log2(apart(runs[0], runs[1]) / apart(runs[1], runs[2]));
    printf("buoyancy, %s: slopes %.2f of the velocity, %.2f of the temperature\n", name, velocity,
           temperature);
    RecordProperty(name, std::to_string(std::min(velocity, temperature)));
    EXPECT_GT(velocity, 1.9);
    EXPECT_GT(temperature, 1.9);
  }
}

/// Square cavity between a hot and a cold wall, alpha = H = dT = 1; `finer`: cells narrow towards the walls.
struct Cavity {
  double nusselt = 0, seconds = 0;
  int sub_steps = 0;
};
Cavity cavity(double rayleigh, int n, double end, double finer = 0) {
  constexpr double prandtl = 0.71;
  FluidParameters p = warm(prandtl, 1, 1e-7);
  p.heat->initial_temperature.text = "300";
  add_buoyancy(p, rayleigh * prandtl);
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["xmin"] = at(boundary(BoundaryType::no_slip), "300.5");
  p.boundaries["xmax"] = at(boundary(BoundaryType::no_slip), "299.5");
  RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3::Ones());
  if (finer > 0)
    for (Vec3& x : raw.points)
      for (int c = 0; c < 2; ++c) x[c] = 0.5 + 0.5 * std::tanh(finer * (2 * x[c] - 1)) / std::tanh(finer);
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  const auto start = std::chrono::steady_clock::now();
  Cavity result;
  double before = 0;
  for (int i = 0; i < 20; ++i) {
    c.run(end * (i + 1) / 20, 4);
    before = std::exchange(result.nusselt, flow(c, "xmin"));
  }
  result.sub_steps = int(c.fluid().statistics().all_sub_steps);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  printf("cavity, Ra %.0e, %d^2%s: Nu %.4f (changed by %.1e of late, cold wall %.4f), %d sub-steps, %.1f s\n",
         rayleigh, n, finer > 0 ? " graded" : "", result.nusselt, result.nusselt - before, -flow(c, "xmax"),
         result.sub_steps, result.seconds);
  return result;
}

void check(const char* name, double found, double wanted, double share) {
  ::testing::Test::RecordProperty(name, std::to_string(found / wanted - 1));
  EXPECT_NEAR(found, wanted, share * wanted);
}

TEST(HeatedCavity, has_the_nusselt_numbers_of_the_benchmark) {
  check("off_1e3", cavity(1e3, 40, 0.6).nusselt, 1.1178, 0.005);
  check("off_1e4", cavity(1e4, 48, 0.4).nusselt, 2.2448, 0.005);
}
TEST(HeatedCavity, of_high_rayleigh_numbers_has_those_of_the_benchmark) {
  check("off_1e5", cavity(1e5, 64, 0.25, 1.2).nusselt, 4.5216, 0.005);
  check("off_1e6", cavity(1e6, 64, 0.15, 1.5).nusselt, 8.8252, 0.005);
}
TEST(HeatedCavity, converges_in_second_order) {
  const double exact = 2.24482;
  double error[2];
  for (int i = 0; i < 2; ++i) error[i] = cavity(1e4, 24 << i, 0.4).nusselt - exact;
  const double slope = std::log2(error[0] / error[1]);
  printf("cavity: slope %.2f\n", slope);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, 1.9);
}

/// Growth rate of a roll between a hot floor and a cold ceiling [a/H^2], in a periodic box of the critical width.
double growth(double rayleigh, int n) {
  const double width = 2.016;
  FluidParameters p = warm(1, 1, 1e-10);
  add_buoyancy(p, rayleigh);
  for (const char* side : {"xmin", "xmax"}) p.boundaries[side] = boundary(BoundaryType::periodic);
  p.boundaries["ymin"] = at(boundary(BoundaryType::no_slip), "301");
  p.boundaries["ymax"] = at(boundary(BoundaryType::no_slip), "300");
  p.heat->initial_temperature.text = fmt::format("301-y+1e-4*sin(pi*y)*cos(2*pi*x/{})", width);
  RawMesh raw = make_box(BoxCells::quadrilaterals, {2 * n, n, 1}, Vec3::Zero(), Vec3(width, 1, 1));
  raw.periodic = {{"xmin", "xmax"}};
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(0.3, 60);
  const double before = c.state().ledger.energy;
  c.run(0.6, 60);
  return std::log(c.state().ledger.energy / before) / (2 * 0.3);
}

TEST(RayleighBenard, sets_in_at_the_critical_rayleigh_number) {
  const double low = growth(1650, 24), high = growth(1770, 24);
  const double critical = 1650 - low * (1770 - 1650) / (high - low);
  printf("Rayleigh-Benard: growth %.3f and %.3f, critical %.1f (1707.8)\n", low, high, critical);
  RecordProperty("critical", std::to_string(critical));
  EXPECT_LT(low, 0);
  EXPECT_GT(high, 0);
  EXPECT_NEAR(critical, 1707.76, 0.02 * 1707.76);
}

/// Heat between cylinders whose diameters are as 2.6 to 1, over that of conduction alone [kuehn1976]; Pr 0.7.
double annulus(double rayleigh, int n) {
  const double gap = 1.6, conducted = 2 * pi / std::log(2.6);
  FluidParameters p = warm(0.7, 1, 1e-7);
  add_buoyancy(p, 0.7 * rayleigh / (gap * gap * gap));
  p.boundaries["inner"] = at(boundary(BoundaryType::no_slip), "301");
  p.boundaries["outer"] = at(boundary(BoundaryType::no_slip), "300");
  p.heat->initial_temperature.text = "300.5";
  RawMesh raw = ring_mesh(n);
  for (Vec3& x : raw.points) x *= 1 + (gap - 1) * (1 - 1 / x.norm());
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(2, 100);
  printf("annulus, Ra %.0e: %.4f inside, %.4f outside\n", rayleigh, flow(c, "inner") / conducted,
         -flow(c, "outer") / conducted);
  return flow(c, "inner") / conducted;
}

TEST(Annulus, has_the_equivalent_conductivity_of_kuehn_and_goldstein) {
  check("off_1e3", annulus(1e3, 16), 1.081, 0.02);
  check("off_1e4", annulus(1e4, 16), 2.010, 0.02);
}

}  // namespace couplet::fluid::test::buoyancy_test
