// SPDX-License-Identifier: Apache-2.0
// Heat in the fluid: order, conservation, boundaries, and flows that buoyancy drives.
#include "fluid_case.hpp"
#include "participant_case.hpp"
#include "ring_mesh.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::fluid::test::heat_test {
using namespace mesh;
using Exact = std::function<double(const Vec3&)>;

constexpr double reference = 300, pi = std::numbers::pi;

/// rho = c = 1, so that k is the diffusivity.
FluidParameters warm(double viscosity, double conductivity, double tolerance = 1e-11) {
  FluidParameters p = fluid_of(1, viscosity, tolerance);
  p.heat.emplace();
  p.heat->conductivity = conductivity;
  p.heat->specific_heat = 1;
  p.heat->reference_temperature = reference;
  p.heat->initial_temperature.text = "300";
  return p;
}

BoundaryParameters at(BoundaryParameters b, const std::string& temperature) {
  b.temperature.emplace().text = temperature;
  return b;
}

template <int D>
double temperature_error(const FluidCase<D>& c, const Exact& exact) {
  const State<D>& s = c.state();
  double square = 0, volume = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    Vec3 x = Vec3::Zero();
    x.head<D>() = s.placement->centre[i];
    square += s.placement->volume[i] * std::pow(reference + s.heat.temperature[i] - exact(x), 2);
    volume += s.placement->volume[i];
  }
  return std::sqrt(sum(MPI_COMM_WORLD, square) / sum(MPI_COMM_WORLD, volume));
}

template <int D>
double stored(const FluidCase<D>& c) {
  double all = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    all += c.state().placement->volume[i] * c.state().heat.temperature[i];
  return sum(MPI_COMM_WORLD, all);
}

/// Sum of V |T - T_ref|, the scale of the balance.
template <int D>
double content(const FluidCase<D>& c) {
  double all = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    all += c.state().placement->volume[i] * std::abs(c.state().heat.temperature[i]);
  return sum(MPI_COMM_WORLD, all);
}

/// Heat into the fluid that a patch conducts, over rho c [K m^3/s].
template <int D>
double flow(const FluidCase<D>& c, const std::string& patch) {
  const Patch& p = *c.mesh().find_patch(patch);
  double all = 0;
  for (Index f = p.first; f < p.first + p.count; ++f) all += c.state().heat.flow[f - c.mesh().n_interior];
  return sum(MPI_COMM_WORLD, all);
}

/// Waves that a uniform stream carries and conduction damps. The mesh swings within the box.
struct Stream {
  bool moves = false, perturbed = false;
  HeatParameters::Convection convection = HeatParameters::Convection::central;
  double conductivity = 0.01;
};
double stream_error(const Stream& q, int n, int steps) {
  const double end = 0.5;
  FluidParameters p = warm(0.01, q.conductivity);
  p.heat->convection = q.convection;
  const std::string wave =
      fmt::format("300+exp(-{}*t)*sin(pi*(x-t))*cos(pi*(y-0.5*t))", 2 * pi * pi * q.conductivity);
  all_sides(p, 2, at(boundary(BoundaryType::inlet, {"1", "0.5"}), wave));
  p.heat->initial_temperature.text = "300+sin(pi*x)*cos(pi*y)";
  p.initial_velocity = {{"1"}, {"0.5"}};
  p.time_step = 1;
  RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(2, 2, 1));
  if (q.perturbed) perturb_interior(raw, 0.2, 3);
  PointMotion motion;
  if (q.moves)
    motion = [](const Vec3& x, GlobalIndex, double t) {
      const double s = 0.1 * std::sin(pi * x[0] / 2) * std::sin(pi * x[1] / 2) * std::sin(4 * t);
      return Vec3(x[0] + s, x[1] - 0.7 * s, x[2]);
    };
  FluidCase<2> c(MPI_COMM_WORLD, raw, p, motion);
  c.run(end, steps);
  const double left = std::exp(-2 * pi * pi * q.conductivity * end);
  return temperature_error<2>(c, [&](const Vec3& x) {
    return reference + left * std::sin(pi * (x[0] - end)) * std::cos(pi * (x[1] - 0.5 * end));
  });
}

void check_order(const char* name, const Stream& q, double least) {
  double error[2];
  for (int i = 0; i < 2; ++i) error[i] = stream_error(q, 24 << i, 40 << i);
  const double slope = std::log2(error[0] / error[1]);
  printf("heat, %s: %.2e %.2e slope %.2f\n", name, error[0], error[1], slope);
  ::testing::Test::RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, least);
  EXPECT_LT(error[1], 0.01);
}

TEST(HeatOrder, is_second_in_space_and_time) { check_order("regular mesh", {}, 1.9); }
TEST(HeatOrder, is_second_on_oblique_cells) { check_order("oblique mesh", {.perturbed = true}, 1.9); }
TEST(HeatOrder, is_second_on_a_moving_mesh) { check_order("moving mesh", {.moves = true}, 1.9); }
TEST(HeatOrder, is_second_where_conduction_prevails) {
  check_order("conduction", {.moves = true, .conductivity = 1}, 1.9);
}
TEST(HeatOrder, of_bounded_convection_is_nearly_second_where_it_is_smooth) {
  check_order("bounded", {.convection = HeatParameters::Convection::bounded}, 1.6);
}

/// On one mesh, by the differences of runs whose steps are halved twice.
TEST(HeatOrder, is_second_in_time) {
  for (const bool moves : {false, true}) {
    std::vector<double> error;
    for (const int steps : {40, 80, 160, 320})
      error.push_back(stream_error({.moves = moves, .conductivity = 0.1}, 16, steps));
    const double slope = std::log2((error[1] - error[2]) / (error[2] - error[3]));
    printf("heat, time%s: differences %.2e %.2e slope %.2f\n", moves ? " on a moving mesh" : "",
           error[1] - error[2], error[2] - error[3], slope);
    RecordProperty(moves ? "moving" : "resting", std::to_string(slope));
    EXPECT_GT(slope, 1.9);
  }
}

/// A vortex in a closed box whose mesh swings: heat is kept, and a uniform temperature stays.
template <int D>
FluidCase<D> vortex(const std::string& initial, HeatParameters::Convection convection, BoxCells cells, int n,
                    double conductivity = 1e-3) {
  FluidParameters p = warm(0.001, conductivity, 1e-14);
  p.heat->convection = convection;
  p.heat->initial_temperature.text = initial;
  all_sides(p, D, boundary(BoundaryType::slip));
  p.initial_velocity = {{"sin(pi*x)*cos(pi*y)"}, {"-cos(pi*x)*sin(pi*y)"}};
  if (D == 3) p.initial_velocity.push_back({"0"});
  RawMesh raw = make_box(cells, {n, n, n}, Vec3::Zero(), Vec3::Ones());
  return FluidCase<D>(MPI_COMM_WORLD, raw, p, [](const Vec3& x, GlobalIndex, double t) {
    Vec3 moved = x;
    double s = 0.08 * std::sin(3 * t);
    for (int c = 0; c < D; ++c) s *= std::sin(pi * x[c]);
    for (int c = 0; c < D; ++c) moved[c] += (c == 1 ? -0.6 : 1) * s;
    return moved;
  });
}

template <int D>
void check_kept(BoxCells cells, int n, HeatParameters::Convection convection) {
  auto hot = vortex<D>("300 + 10*exp(-20*((x-0.3)^2+(y-0.4)^2))", convection, cells, n);
  auto even = vortex<D>("310", convection, cells, n);
  const double before = stored(hot);
  double most = 0;
  for (int i = 0; i < 20; ++i) {
    hot.step(0.02);
    even.step(0.02);
    most = std::max(most, std::abs(stored(hot) - before) / before);
  }
  double uneven = 0;
  for (Index c = 0; c < even.mesh().cells.n_owned(); ++c)
    uneven = std::max(uneven, std::abs(even.state().heat.temperature[c] - 10));
  uneven = max(MPI_COMM_WORLD, uneven);
  printf("heat, %d-D: conservation %.1e, uniform %.1e K of 10 K\n", D, most, uneven);
  ::testing::Test::RecordProperty("conservation", std::to_string(most * 1e12) + "e-12");
  EXPECT_LT(most, 1e-12);
  EXPECT_LT(uneven, 1e-11);  // 1e-12 of the difference from the reference
}

using enum HeatParameters::Convection;
TEST(HeatBalance, is_kept_on_moving_quadrilaterals) { check_kept<2>(BoxCells::quadrilaterals, 12, central); }
TEST(HeatBalance, is_kept_on_moving_triangles) { check_kept<2>(BoxCells::triangles, 8, central); }
TEST(HeatBalance, is_kept_on_moving_hexahedra) { check_kept<3>(BoxCells::hexahedra, 6, central); }
TEST(HeatBalance, is_kept_by_bounded_convection) { check_kept<2>(BoxCells::quadrilaterals, 12, bounded); }

/// Each step of a channel with a given temperature, a flux and a film adds what its boundary has supplied.
TEST(HeatBalance, of_each_step_closes_with_what_the_boundary_supplies) {
  FluidParameters p = channel();
  p.heat = warm(1, 0.02).heat;
  p.boundaries["xmin"] = at(p.boundaries["xmin"], "320+5*sin(3*t)");
  p.boundaries["ymax"].film.emplace().coefficient.text = "0.5";
  p.boundaries["ymax"].film->ambient.text = "280";
  p.boundaries["ymin"] = boundary(BoundaryType::no_slip);
  p.boundaries["ymin"].heat_flux.emplace().text = "3*x";
  FluidCase<2> c(MPI_COMM_WORLD, channel_mesh(), p);
  double most = 0, before = 0;
  for (int i = 0; i < 30; ++i) {
    c.step(0.02);
    const double open = stored(c) - sum(MPI_COMM_WORLD, c.state().heat.received);
    most = std::max(most, std::abs(open - before) / content(c));
    before = open;
  }
  printf("heat balance of a step: %.1e\n", most);
  RecordProperty("imbalance", std::to_string(most * 1e10) + "e-10");
  EXPECT_LT(most, 1e-10);
}

/// Heat through a slab from a given temperature to a film, and a given flux, on oblique cells: linear profiles are exact.
TEST(HeatBoundaries, a_slab_has_the_flux_of_its_resistances_in_series) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {8, 6, 1}, Vec3::Zero(), Vec3(2, 1, 1));
  perturb_interior(raw, 0.2, 5);
  FluidParameters p = warm(1, 0.5, 1e-12);
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["xmin"] = at(boundary(BoundaryType::no_slip), "340");
  BoundaryParameters& cold = p.boundaries["xmax"];
  cold.film.emplace().coefficient.text = "0.4";
  cold.film->ambient.text = "280";
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(400, 40);
  const double flux = 60 / (2 / 0.5 + 1 / 0.4);
  EXPECT_NEAR(flow(c, "xmin"), flux, 1e-7 * flux);
  EXPECT_NEAR(flow(c, "xmax"), -flux, 1e-7 * flux);
  EXPECT_LT(temperature_error<2>(c, [&](const Vec3& x) { return 340 - flux / 0.5 * x[0]; }), 1e-6);
  cold.film.reset();
  cold.heat_flux.emplace().text = "-6";
  FluidCase<2> given(MPI_COMM_WORLD, raw, p);
  given.run(400, 40);
  EXPECT_NEAR(flow(given, "xmin"), 6, 1e-6);
  EXPECT_LT(temperature_error<2>(given, [&](const Vec3& x) { return 340 - 12 * x[0]; }), 1e-6);
}

/// Fluid that enters has the temperature of the patch, or the initial one; what leaves has that of the cells.
TEST(HeatBoundaries, inflow_brings_its_temperature_and_outflow_takes_that_of_the_cells) {
  FluidParameters p = warm(0.01, 1e-3);
  p.boundaries["xmin"] = at(boundary(BoundaryType::inlet, {"1", "0"}), "310");
  p.boundaries["xmax"] = at(boundary(BoundaryType::outlet), "1000");  // not used: nothing enters there
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
  p.initial_velocity = {{"1"}, {"0"}};
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {20, 4, 1}, Vec3::Zero(), Vec3(1, 0.2, 1));
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  c.run(4, 80);
  EXPECT_LT(temperature_error<2>(c, [](const Vec3&) { return 310; }), 1e-6);
  p.boundaries["xmin"].temperature.reset();
  FluidCase<2> as_at_the_start(MPI_COMM_WORLD, raw, p);
  as_at_the_start.run(1, 20);
  EXPECT_LT(temperature_error<2>(as_at_the_start, [](const Vec3&) { return 300; }), 1e-10);
  p.boundaries["xmax"].pressure.text = "1";  // the fluid turns back
  FluidCase<2> back(MPI_COMM_WORLD, raw, p);
  EXPECT_LT(temperature_error<2>(back, [](const Vec3&) { return 300; }), 1e-10);
}

/// A hot block that a vortex stretches keeps its extremes with bounded convection.
TEST(HeatConvection, bounded_makes_no_new_extremes) {
  for (const auto convection : {central, bounded}) {
    auto c = vortex<2>("x > 0.2 && x < 0.5 && y > 0.3 && y < 0.7 ? 310 : 300", convection,
                       BoxCells::quadrilaterals, 24, 1e-3);
    double low = 0, high = 0;
    for (int i = 0; i < 40; ++i) {
      c.step(0.01);
      for (Index k = 0; k < c.mesh().cells.n_owned(); ++k) {
        low = std::min(low, c.state().heat.temperature[k]);
        high = std::max(high, c.state().heat.temperature[k] - 10);
      }
    }
    low = min(MPI_COMM_WORLD, low), high = max(MPI_COMM_WORLD, high);
    printf("heat, %s: beyond the extremes by %.1e and %.1e of 10 K\n",
           convection == bounded ? "bounded" : "central", -low, high);
    if (convection == bounded) {
      EXPECT_GT(low, -1e-6);
      EXPECT_LT(high, 1e-6);
    } else {
      EXPECT_LT(low, -0.01);
    }
  }
}

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

TEST(HeatedCavity, has_the_nusselt_numbers_of_the_benchmark) {
  EXPECT_NEAR(cavity(1e3, 40, 0.6).nusselt, 1.1178, 0.005 * 1.1178);
  EXPECT_NEAR(cavity(1e4, 48, 0.4).nusselt, 2.2448, 0.005 * 2.2448);
}
TEST(HeatedCavity, of_high_rayleigh_numbers_has_those_of_the_benchmark) {
  EXPECT_NEAR(cavity(1e5, 64, 0.25, 1.2).nusselt, 4.5216, 0.005 * 4.5216);
  EXPECT_NEAR(cavity(1e6, 64, 0.15, 1.5).nusselt, 8.8252, 0.005 * 8.8252);
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

}  // namespace couplet::fluid::test::heat_test
