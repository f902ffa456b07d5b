// SPDX-License-Identifier: Apache-2.0
// Viscosity laws: fully developed flows beside their closed forms or an ordinary equation, forces on walls, energy and steps.
#include "fluid_case.hpp"
#include "fluid_solver/output/derived.hpp"
#include "heat_case.hpp"
#include "participant_case.hpp"
#include "ring_mesh.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::fluid::test::viscosity_law_test {
using namespace mesh;

constexpr double pi = std::numbers::pi, half = 0.5;  // half the width of the channel [m]

ViscosityLaw power_law(double consistency, double index, double most = 1e3) {
  return {.type = ViscosityLaw::Type::power_law, .index = index, .consistency = consistency, .most = most};
}
ViscosityLaw carreau_yasuda(double zero, double infinite, double time, double index, double yasuda) {
  return {.type = ViscosityLaw::Type::carreau_yasuda,
          .index = index,
          .most = {},
          .zero_shear = zero,
          .infinite_shear = infinite,
          .time = time,
          .yasuda = yasuda};
}
ViscosityLaw cross(double zero, double infinite, double time, double index) {
  return {.type = ViscosityLaw::Type::cross,
          .index = index,
          .most = {},
          .zero_shear = zero,
          .infinite_shear = infinite,
          .time = time};
}
ViscosityLaw herschel_bulkley(double yield, double consistency, double index, double regularization) {
  return {.type = ViscosityLaw::Type::herschel_bulkley,
          .index = index,
          .consistency = consistency,
          .most = {},
          .yield_stress = yield,
          .regularization = regularization};
}

double slope(double coarse, double fine) { return std::log2(coarse / fine); }

/// Shear rate at which a law gives a stress, by bisection.
double shear_rate_of(const ViscosityLaw& law, double stress) {
  double low = 0, high = 1;
  while (law(high) * high < stress) high *= 2;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (law(middle) * middle < stress ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// u(y) in a channel with walls at 0 and 1 under the force `force` per volume: integral of the shear rate at the stress
/// force |1/2 - y|, by the midpoint rule.
std::function<Vec3(const Vec3&)> channel_profile(const ViscosityLaw& law, double force) {
  constexpr int n = 4000;
  std::vector<double> velocity(n + 1, 0.0);
  for (int i = 0; i < n; ++i)
    velocity[i + 1] = velocity[i] + half / n * shear_rate_of(law, force * (half - half * (i + 0.5) / n));
  return [velocity](const Vec3& x) {
    const double at = std::min(x.y(), 1 - x.y()) / half * n;
    const int i = std::min(int(at), n - 1);
    return Vec3(std::lerp(velocity[i], velocity[i + 1], at - i), 0, 0);
  };
}

/// Closed form of a power law: n/(n+1) (G/K)^(1/n) [h^(1+1/n) - |y - h|^(1+1/n)].
std::function<Vec3(const Vec3&)> power_profile(const ViscosityLaw& law, double force) {
  return [=](const Vec3& x) {
    const double power = 1 + 1 / law.index;
    return Vec3(std::pow(force / law.consistency, 1 / law.index) / power *
                    (std::pow(half, power) - std::pow(std::abs(x.y() - half), power)),
                0, 0);
  };
}

/// Driven by a force of 1 N/m^3 along x, periodic, walls at y = 0 and 1; density 1 kg/m^3.
FluidParameters driven_channel(const ViscosityLaw& law) {
  FluidParameters p = fluid_of(1, 0, 1e-10);
  p.viscosity_law = law;
  p.viscous = ViscousTreatment::implicit;
  p.body_force = {{"1"}, {"0"}};
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::periodic);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  return p;
}

RawMesh channel_of(BoxCells cells, int across, int along, double length) {
  RawMesh raw = make_box(cells, {along, across, 1}, Vec3::Zero(), Vec3(length, 1, 1));
  raw.periodic = {{"xmin", "xmax"}};
  return raw;
}
RawMesh strip(int across) { return channel_of(BoxCells::quadrilaterals, across, 2, 2. / across); }

/// Runs until the velocity changes by less than 1e-9 of itself in a step, at most `most` steps of dt [s].
template <int D>
void settle(FluidCase<D>& c, double dt, int most) {
  for (int i = 0; i < most; ++i) {
    const Vectors<D> before = c.state().u;
    c.step(dt);
    double change = 0, size = 0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      change = std::max(change, (c.state().u[k] - before[k]).norm());
      size = std::max(size, before[k].norm());
    }
    if (parallel::max(c.mesh().comm, change) < 1e-9 * parallel::max(c.mesh().comm, size)) return;
  }
  ADD_FAILURE() << "not steady after " << most << " steps";
}

template <int D>
Vec<D> wall_force(FluidCase<D>& c, const std::vector<std::string>& patches) {
  Vec<D> sum = Vec<D>::Zero();
  for (const std::string& name : patches) {
    const Patch& patch = *c.mesh().find_patch(name);
    for (Index b = patch.first - c.mesh().n_interior; b < patch.first + patch.count - c.mesh().n_interior;
         ++b)
      sum += c.fluid().viscous_force()[b] + c.fluid().pressure_force()[b];
  }
  for (double& s : sum) s = parallel::sum(c.mesh().comm, s);
  return sum;
}

/// Error of the velocity over the largest velocity.
double relative_error(const FluidCase<2>& c, const std::function<Vec3(const Vec3&)>& exact) {
  return c.velocity_error(exact) / exact(Vec3(0, half, 0)).x();
}

void check_power_law(double index, BoxCells cells, double least_slope) {
  const bool triangles = cells == BoxCells::triangles;
  // On triangles the steps follow the largest viscosity.
  const ViscosityLaw law = triangles ? power_law(0.5, index, 2) : power_law(1, index);
  const auto exact = triangles ? channel_profile(law, 1) : power_profile(law, 1);
  double error[3], missing = 0;
  for (int i = 0; i < 3; ++i) {
    const int n = (triangles ? 8 : 16) << i;
    RawMesh raw = cells == BoxCells::triangles ? channel_of(cells, n, n / 4, 0.25) : strip(n);
    if (cells == BoxCells::triangles) perturb_interior(raw, 0.1, 3);
    FluidParameters p = driven_channel(law);
    if (triangles) p.initial_velocity = {{"4/3*(0.125-abs(y-0.5)^3)"}, {"0"}};
    FluidCase<2> c(MPI_COMM_WORLD, raw, p);
    triangles ? c.run(2, 20) : settle(c, 0.05, 4000);
    error[i] = relative_error(c, exact);
    const double volume = cells == BoxCells::triangles ? 0.25 : 2. / n;
    missing = std::max(missing, std::abs(wall_force<2>(c, {"ymin", "ymax"}).x() / volume - 1));
  }
  printf("power law %.1f: errors %.2e %.2e %.2e slopes %.2f %.2f, force off by %.1e\n", index, error[0],
         error[1], error[2], slope(error[0], error[1]), slope(error[1], error[2]), missing);
  ::testing::Test::RecordProperty("slope", std::to_string(slope(error[1], error[2])));
  ::testing::Test::RecordProperty("error", std::to_string(error[2]));
  EXPECT_GT(slope(error[1], error[2]), least_slope);
  EXPECT_LT(error[2], 2e-3);
  EXPECT_LT(missing, cells == BoxCells::triangles ? 1e-3 : 1e-6);
}

TEST(PowerLaw, thins_in_a_channel_with_second_order) { check_power_law(0.5, BoxCells::quadrilaterals, 1.9); }
TEST(PowerLaw, thickens_in_a_channel_with_second_order) {
  check_power_law(1.5, BoxCells::quadrilaterals, 1.9);
}
TEST(PowerLaw, thins_in_a_channel_of_triangles_with_second_order) {
  check_power_law(0.5, BoxCells::triangles, 1.8);
}

/// A flow that is developed where it enters stays so up to the outlet, with the pressure gradient of the walls.
TEST(PowerLaw, leaves_a_channel_as_it_enters) {
  const ViscosityLaw law = power_law(1, 0.5, 100);
  FluidParameters p = fluid_of(1, 0, 1e-10);
  p.viscosity_law = law;
  p.viscous = ViscousTreatment::implicit;
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"(0.125-abs(y-0.5)^3)/3", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.initial_velocity = p.boundaries["xmin"].velocity;
  double error[2], gradient[2];
  for (int i = 0; i < 2; ++i) {
    const int n = 16 << i;
    FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 1)),
                   p);
    c.run(10, 500);
    error[i] = relative_error(c, power_profile(law, 1));
    gradient[i] = c.pressure_error([](const Vec3& x) { return -x.x(); });
  }
  printf("channel with ends: velocity %.2e %.2e, pressure %.2e %.2e\n", error[0], error[1], gradient[0],
         gradient[1]);
  EXPECT_LT(error[1], 2e-3);
  EXPECT_GT(slope(error[0], error[1]), 1.8);
  EXPECT_LT(gradient[1], 5e-3);
}

/// A square of n x n cells drawn onto a circle of radius 1, and two layers of it along z.
RawMesh pipe_mesh(int n) {
  RawMesh raw = make_box(BoxCells::hexahedra, {n, n, 2}, Vec3(-1, -1, 0), Vec3(1, 1, 2. / n));
  for (Vec3& x : raw.points) {
    const double square = std::max(std::abs(x.x()), std::abs(x.y())), round = std::hypot(x.x(), x.y());
    if (!(round > 0)) continue;
    const double share = square * square, factor = share * square / round + (1 - share) * 0.75;
    x.x() *= factor, x.y() *= factor;
  }
  raw.periodic = {{"zmin", "zmax"}};
  return raw;
}

TEST(PowerLaw, flows_through_a_pipe_of_hexahedra) {
  constexpr int n = 40;
  const ViscosityLaw law = power_law(1, 0.5);
  FluidParameters p = fluid_of(1, 0, 1e-9);
  p.viscosity_law = law;
  p.viscous = ViscousTreatment::implicit;
  p.body_force = {{"0"}, {"0"}, {"2"}};
  all_sides(p, 3, boundary(BoundaryType::no_slip));
  p.boundaries["zmin"] = p.boundaries["zmax"] = boundary(BoundaryType::periodic);
  FluidCase<3> c(MPI_COMM_WORLD, pipe_mesh(n), p);
  settle(c, 0.05, 2000);
  // Stress r, shear rate r^2: u = (1 - r^3)/3, flow pi/5 through the circle.
  double flow = 0, area = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    const double volume = c.state().placement->volume[i];
    flow += volume * c.state().u[i].z(), area += volume;
  }
  const double length = 2. / n;
  flow = parallel::sum(MPI_COMM_WORLD, flow) / length, area = parallel::sum(MPI_COMM_WORLD, area) / length;
  // The flow through a pipe goes with the power 1/n + 3 of its radius.
  const double wanted = pi / 5 * std::pow(area / pi, 2.5);
  const double error = c.velocity_error(
      [](const Vec3& x) { return Vec3(0, 0, (1 - std::pow(std::hypot(x.x(), x.y()), 3)) / 3); });
  const double force = wall_force<3>(c, {"xmin", "xmax", "ymin", "ymax"}).z() / (2 * area * length);
  printf(
      "pipe: flow %.5f of %.5f (%.5f of the circle), velocity off by %.2e of the largest, force over weight %.6f\n",
      flow, wanted, pi / 5, 3 * error, force);
  RecordProperty("flow_error", std::to_string(flow / wanted - 1));
  EXPECT_NEAR(flow, wanted, 0.005 * wanted);
  EXPECT_LT(3 * error, 0.01);
  EXPECT_NEAR(force, 1, 1e-3);
}

/// Between a cylinder that turns and one at rest: r^2 stress = const. The turn of the wall is a part of its shear rate.
TEST(PowerLaw, turns_between_cylinders_with_the_torque_of_the_closed_form) {
  const ViscosityLaw law = power_law(1, 0.5, 100);
  const double speed = 1;
  FluidParameters p = fluid_of(1, 0, 1e-10);
  p.viscosity_law = law;
  p.viscous = ViscousTreatment::implicit;
  p.initial_velocity = {{"-y*(4/(x^2+y^2)^2-0.25)/3.75"}, {"x*(4/(x^2+y^2)^2-0.25)/3.75"}};
  p.boundaries["outer"] = boundary(BoundaryType::no_slip);
  p.boundaries["inner"] = boundary(BoundaryType::moving_wall);
  p.boundaries["inner"].rotation = RotationParameters{.speed = {fmt::format("{}", speed)}};
  // omega(r) = C^2/4 (r^-4 - 1/16), r^2 stress = C.
  const double constant = std::sqrt(4 * speed / (1 - 1. / 16)), torque = 2 * pi * constant;
  const auto exact = [&](const Vec3& x) {
    const double r = std::hypot(x.x(), x.y()), omega = constant * constant / 4 * (std::pow(r, -4) - 1. / 16);
    return Vec3(-omega * x.y(), omega * x.x(), 0);
  };
  double error[2], off[2];
  for (int i = 0; i < 2; ++i) {
    FluidCase<2> c(MPI_COMM_WORLD, ring_mesh(8 << i), p);
    settle(c, 0.02, 2000);
    error[i] = c.velocity_error(exact);
    off[i] = std::abs(std::abs(moment(c.fluid(), {"inner"})) / torque - 1);
  }
  printf("cylinders: errors %.2e %.2e slope %.2f, torque off by %.2e %.2e\n", error[0], error[1],
         slope(error[0], error[1]), off[0], off[1]);
  EXPECT_GT(slope(error[0], error[1]), 1.8);
  EXPECT_LT(off[1], 0.01);
  EXPECT_LT(off[1], off[0]);
}

/// A law beside the integral of its own ordinary equation.
void check_channel(const char* name, const ViscosityLaw& law, double dt, double tolerance, int across = 48) {
  FluidCase<2> c(MPI_COMM_WORLD, strip(across), driven_channel(law));
  settle(c, dt, 20000);
  const double error = relative_error(c, channel_profile(law, 1));
  const double force = wall_force<2>(c, {"ymin", "ymax"}).x() / (2. / across);
  printf("%s: velocity off by %.2e of the largest %.4f, force over weight - 1 = %.1e\n", name, error,
         channel_profile(law, 1)(Vec3(0, half, 0)).x(), force - 1);
  ::testing::Test::RecordProperty("error", std::to_string(error));
  EXPECT_LT(error, tolerance);
  EXPECT_NEAR(force, 1, 1e-6);
}
TEST(CarreauYasuda, flows_as_its_ordinary_equation_says) {
  check_channel("Carreau-Yasuda", carreau_yasuda(1, 0.02, 5, 0.4, 1.25), 0.05, 2e-3);
}
TEST(Cross, flows_as_its_ordinary_equation_says) {
  check_channel("Cross", cross(1, 0.02, 5, 0.3), 0.05, 2e-3);
}
TEST(HerschelBulkley, flows_as_its_ordinary_equation_says) {
  check_channel("Herschel-Bulkley", herschel_bulkley(0.15, 1, 0.7, 1000), 0.01, 2e-3);
}

/// Bingham's fluid: u = (h - y_0)^2/2 (1 - ((s - y_0)/(h - y_0))^2), s the distance from the middle, a plug up to y_0 = tau_0/G.
TEST(HerschelBulkley, has_the_plug_of_a_bingham_fluid) {
  constexpr double yield = 0.2, regularization = 2000;
  const auto ideal = [=](const Vec3& x) {
    const double s = std::max(std::abs(x.y() - half), yield), free = half - yield;
    return Vec3(0.5 * (free * free - (s - yield) * (s - yield)), 0, 0);
  };
  const ViscosityLaw law = herschel_bulkley(yield, 1, 1, regularization);
  FluidCase<2> c(MPI_COMM_WORLD, strip(50), driven_channel(law));
  settle(c, 0.01, 20000);
  const double error = relative_error(c, ideal), own = relative_error(c, channel_profile(law, 1));
  double slowest = 1, fastest = 0;  // in the plug
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    if (std::abs(c.state().placement->centre[i].y() - half) < 0.15) {
      slowest = std::min(slowest, c.state().u[i].x());
      fastest = std::max(fastest, c.state().u[i].x());
    }
  slowest = parallel::min(MPI_COMM_WORLD, slowest), fastest = parallel::max(MPI_COMM_WORLD, fastest);
  printf("Bingham: %.2e off the ideal fluid, %.2e off the regularized one; plug %.5f to %.5f\n", error, own,
         slowest, fastest);
  RecordProperty("error", std::to_string(error));
  EXPECT_LT(error, 0.01);
  EXPECT_LT(own, 2e-3);
  EXPECT_LT(fastest - slowest, 0.005 * fastest);
}

FluidParameters cavity(std::optional<ViscosityLaw> law, ViscousTreatment viscous) {
  FluidParameters p = fluid_of(2, law ? 0 : 0.05, 1e-10);
  p.viscosity_law = law;
  p.viscous = viscous;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  return p;
}
RawMesh square(BoxCells cells, int n) {
  RawMesh raw = make_box(cells, {n, n, 1}, Vec3::Zero(), Vec3::Ones());
  perturb_interior(raw, 0.1, 4);
  return raw;
}

/// A law whose viscosity does not vary is the number, explicit and implicit.
TEST(ConstantLaw, gives_what_the_number_gives) {
  ViscosityLaw carreau = carreau_yasuda(0.05, 0.01, 1, 1, 2), bingham = herschel_bulkley(0, 0.05, 1, 10);
  for (const ViscousTreatment viscous : {ViscousTreatment::explicit_, ViscousTreatment::implicit})
    for (const ViscosityLaw& law : {power_law(0.05, 1), carreau, bingham}) {
      FluidCase<2> number(MPI_COMM_WORLD, square(BoxCells::triangles, 8), cavity({}, viscous)),
          same(MPI_COMM_WORLD, square(BoxCells::triangles, 8), cavity(law, viscous));
      number.run(0.5, 10), same.run(0.5, 10);
      EXPECT_LT(difference(number, same), 1e-10);
      EXPECT_TRUE(number.state().excess.empty());
      const Vec<2> forces[] = {wall_force<2>(number, {"ymax"}), wall_force<2>(same, {"ymax"})};
      EXPECT_LT((forces[0] - forces[1]).norm(), 1e-10);
    }
}

/// The power that the budget names is what the kinetic energy loses.
/// Between plates of 300 and 301 K, of which the warm one moves at 1 m/s, under a viscosity of 1 to 3 Pa s: u = ln(1 + 2 y)/ln 3, and the
/// shear stress is 2/ln 3.
TEST(ViscosityByTemperature, has_the_closed_form_of_a_sheared_layer) {
  double error[2], missing = 0;
  for (int i = 0; i < 2; ++i) {
    const int n = 16 << i;
    FluidParameters p = driven_channel(power_law(1, 1));
    p.viscosity_law->by_temperature.emplace().text = "table(T, 300, 1, 301, 3)";
    p.body_force.clear();
    p.heat = warm(1, 1).heat;
    p.boundaries["ymin"] = at(boundary(BoundaryType::no_slip), "300");
    p.boundaries["ymax"] = at(boundary(BoundaryType::moving_wall), "301");
    p.boundaries["ymax"].velocity = {{"1"}, {"0"}};
    FluidCase<2> c(MPI_COMM_WORLD, strip(n), p);
    settle(c, 0.02, 4000);
    error[i] =
        c.velocity_error([](const Vec3& x) { return Vec3(std::log(1 + 2 * x.y()) / std::log(3.), 0, 0); });
    missing = wall_force<2>(c, {"ymin"}).x() * n / 2 / (2 / std::log(3.)) - 1;
  }
  printf("viscosity by temperature: errors %.2e %.2e, slope %.2f, force off by %.1e\n", error[0], error[1],
         slope(error[0], error[1]), missing);
  RecordProperty("slope", std::to_string(slope(error[0], error[1])));
  EXPECT_GT(slope(error[0], error[1]), 1.9);
  EXPECT_LT(std::abs(missing), 1e-3);
}

TEST(ViscosityByTemperature, may_be_a_number) {
  double speed[2];
  for (int i = 0; i < 2; ++i) {
    FluidParameters p = driven_channel(power_law(i == 0 ? 1 : 2, 1));
    p.heat = warm(1, 1).heat;
    if (i == 1) p.viscosity_law->by_temperature.emplace().text = "0.5";
    FluidCase<2> c(MPI_COMM_WORLD, strip(8), p);
    settle(c, 0.02, 4000);
    speed[i] = c.state().largest_speed;
  }
  EXPECT_NEAR(speed[1], speed[0], 1e-7 * speed[0]);
}

TEST(ViscosityLaw, takes_the_energy_that_the_budget_names) {
  FluidParameters p = fluid_of(2, 0, 1e-10);
  p.viscosity_law = carreau_yasuda(0.2, 0.02, 2, 0.4, 2);
  p.viscous = ViscousTreatment::explicit_;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.initial_velocity = {{"sin(pi*x)^2*sin(2*pi*y)"}, {"-sin(pi*y)^2*sin(2*pi*x)"}};
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {40, 40, 1}, Vec3::Zero(), Vec3::Ones()),
                 p);
  c.run(0.1, 20);
  const EnergyBudget before = energy_budget(c.fluid());
  c.run(0.12, 10);
  const EnergyBudget after = energy_budget(c.fluid());
  const double lost = (before.kinetic - after.kinetic) / 0.02,
               viscous = 0.5 * (before.viscous + after.viscous),
               named = viscous + 0.5 * (before.pressure + after.pressure);
  printf("energy lost %.4f W, named %.4f W (viscous %.4f W)\n", lost, named, viscous);
  EXPECT_NEAR(lost, named, 0.01 * named);
  EXPECT_GT(lost, 0.1 * before.kinetic);
}

/// Steps of a hundred times the explicit limit are stable, and of second order in time, for fluids that thin and thicken.
TEST(ViscosityLaw, does_not_limit_an_implicit_step) {
  for (const ViscosityLaw& law : {carreau_yasuda(2, 0.02, 5, 0.4, 2), power_law(0.3, 1.5, 100)}) {
    FluidParameters p = fluid_of(1, 0, 1e-10);
    p.viscosity_law = law;
    p.viscous = ViscousTreatment::implicit;
    all_sides(p, 2, boundary(BoundaryType::no_slip));
    p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"sin(pi*t)^2*sin(pi*x)^2", "0"});
    p.time_step = 1;
    const RawMesh raw = make_box(BoxCells::quadrilaterals, {16, 16, 1}, Vec3::Zero(), Vec3::Ones());
    const auto run = [&](int steps) {
      auto c = std::make_unique<FluidCase<2>>(MPI_COMM_WORLD, raw, p);
      c->run(0.5, steps);
      return c;
    };
    FluidParameters own = p;
    own.time_step.reset();
    own.viscous = ViscousTreatment::explicit_;
    FluidCase<2> neighbour(MPI_COMM_WORLD, raw, own);
    neighbour.run(0.5, 1);
    const int sub_steps = neighbour.fluid().statistics().sub_steps;
    const auto exact = run(320), coarse = run(20), fine = run(40), finest = run(80);
    const double errors[] = {difference(*coarse, *exact), difference(*fine, *exact),
                             difference(*finest, *exact)};
    const double off = difference(neighbour, *exact);
    printf("explicit: %d sub-steps (%.2e apart); implicit: errors %.2e %.2e %.2e, slopes %.2f %.2f\n",
           sub_steps, off, errors[0], errors[1], errors[2], slope(errors[0], errors[1]),
           slope(errors[1], errors[2]));
    EXPECT_GT(sub_steps, 500);
    EXPECT_LT(off, 1e-3);
    EXPECT_GT(slope(errors[1], errors[2]), 1.7);
  }
}

/// Interior points circle about their places.
Vec3 swirl(const Vec3& x, GlobalIndex, double t) {
  const double shape = std::sin(pi * x.x()) * std::sin(pi * x.y());
  return x + 0.05 * shape * Vec3(std::sin(9 * t), 1 - std::cos(12 * t), 0);
}

TEST(ViscosityLaw, is_second_order_in_time_on_a_moving_mesh) {
  for (const ViscousTreatment viscous : {ViscousTreatment::explicit_, ViscousTreatment::implicit}) {
    std::vector<std::unique_ptr<FluidCase<2>>> runs;
    for (int i = 0; i < 4; ++i) {
      FluidParameters p = cavity(carreau_yasuda(0.2, 0.02, 2, 0.4, 2), viscous);
      p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
      p.initial_velocity = {{"sin(pi*x)^2*sin(2*pi*y)"}, {"-sin(pi*y)^2*sin(2*pi*x)"}};
      p.time_step = 0.2 / (40 << i);
      runs.push_back(std::make_unique<FluidCase<2>>(
          MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {16, 16, 1}, Vec3::Zero(), Vec3::Ones()), p,
          swirl));
      runs.back()->run(0.2, 40 << i);
    }
    const double d[] = {difference(*runs[0], *runs[1]), difference(*runs[1], *runs[2]),
                        difference(*runs[2], *runs[3])};
    printf("moving mesh: %.2e %.2e %.2e slopes %.2f %.2f\n", d[0], d[1], d[2], slope(d[0], d[1]),
           slope(d[1], d[2]));
    EXPECT_GT(slope(d[1], d[2]), 1.8);
  }
}

/// Cylinders of a thinning fluid, the inner one of which turns faster and faster.
FluidParameters faster_and_faster(ViscousTreatment viscous) {
  FluidParameters p = fluid_of(1, 0, 1e-11, "ring");
  p.viscosity_law = carreau_yasuda(0.2, 0.02, 2, 0.4, 2);
  p.viscous = viscous;
  p.boundaries["outer"] = boundary(BoundaryType::no_slip);
  p.boundaries["inner"] = boundary(BoundaryType::moving_wall);
  p.boundaries["inner"].rotation = RotationParameters{.speed = {"1+t"}};
  return p;
}

TEST(ViscosityLaw, goes_on_from_a_checkpoint_bit_for_bit) {
  for (const ViscousTreatment viscous : {ViscousTreatment::explicit_, ViscousTreatment::implicit}) {
    const auto make = [&] {
      return std::make_unique<FluidParticipant<2>>(distribute(MPI_COMM_WORLD, ring_mesh(6)),
                                                   faster_and_faster(viscous), FluidContext{}, MotionLink{});
    };
    const auto first = make(), second = make();
    take_steps(*first, 0, 4);
    support::SavedState(*first).load_into(*second);
    EXPECT_EQ(first->fluid().state().excess, second->fluid().state().excess);
    take_steps(*first, 4, 8);
    take_steps(*second, 4, 8);
    EXPECT_EQ(first->fluid().state().u, second->fluid().state().u);
    EXPECT_EQ(first->fluid().viscous_force(), second->fluid().viscous_force());
  }
}

TEST(ViscosityLaw, gives_the_same_on_any_number_of_ranks) {
  const ViscosityLaw law = carreau_yasuda(0.5, 0.02, 2, 0.4, 2);
  for (const ViscousTreatment viscous : {ViscousTreatment::explicit_, ViscousTreatment::implicit}) {
    FluidCase<2> many(MPI_COMM_WORLD, square(BoxCells::triangles, 8), cavity(law, viscous)),
        one(MPI_COMM_SELF, square(BoxCells::triangles, 8), cavity(law, viscous));
    many.run(0.5, 10), one.run(0.5, 10);
    const EnergyBudget a = energy_budget(many.fluid()), b = energy_budget(one.fluid());
    EXPECT_NEAR(a.kinetic, b.kinetic, 1e-8 * b.kinetic);
    EXPECT_NEAR(a.viscous, b.viscous, 1e-8 * b.viscous);
    EXPECT_LT((wall_force<2>(many, {"ymax"}) - wall_force<2>(one, {"ymax"})).norm(), 1e-8);
  }
}

TEST(ViscosityLaws, have_the_values_of_their_formulas) {
  EXPECT_DOUBLE_EQ(power_law(3, 0.5)(4), 1.5);
  EXPECT_EQ(power_law(3, 0.5, 10)(0), 10);
  EXPECT_DOUBLE_EQ(carreau_yasuda(5, 1, 2, 0.5, 2)(0), 5);
  EXPECT_NEAR(carreau_yasuda(5, 1, 2, 0.5, 2)(1.5), 1 + 4 * std::pow(10, -0.25), 1e-14);
  EXPECT_NEAR(cross(5, 1, 2, 0.5)(2), 1 + 4. / 3, 1e-14);
  EXPECT_DOUBLE_EQ(herschel_bulkley(2, 3, 1, 10)(0), 23);
  EXPECT_NEAR(herschel_bulkley(2, 3, 0.5, 10)(0.01), 3 * std::sqrt(10) + 200 * (1 - std::exp(-0.1)), 1e-12);
  for (const ViscosityLaw& law : {power_law(3, 0.5, 10), carreau_yasuda(5, 1, 2, 0.5, 1), cross(5, 1, 2, 0.3),
                                  herschel_bulkley(2, 3, 0.5, 10), herschel_bulkley(2, 3, 1.5, 10)})
    for (double rate = 1e-4; rate < 1e4; rate *= 3) {
      EXPECT_GE(law(rate), law.smallest());
      EXPECT_LE(law(rate), law.largest());
      EXPECT_LE(std::log(law(1.01 * rate) / law(rate)) / std::log(1.01) + 1, law.stiffening() + 1e-9);
    }
}

}  // namespace couplet::fluid::test::viscosity_law_test
