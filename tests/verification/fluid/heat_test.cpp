// SPDX-License-Identifier: Apache-2.0
// Heat in the fluid: order, conservation, boundaries, restart.
#include "heat_case.hpp"
#include "participant_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::fluid::test::heat_test {
using namespace mesh;
using parallel::max, parallel::min, parallel::sum;

constexpr double pi = std::numbers::pi;

/// Waves that a uniform stream carries and conduction damps. The mesh swings within the box.
struct Stream {
  bool moves = false, sheared = false, random = false;
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
  if (q.random) perturb_interior(raw, 0.2, 3);
  const auto waved = [](const Vec3& x, double size) {
    const double s = size * std::sin(pi * x[0] / 2) * std::sin(pi * x[1] / 2);
    return Vec3(x[0] + s, x[1] - 0.7 * s, x[2]);
  };
  if (q.sheared)
    for (Vec3& x : raw.points) x = waved(x, 0.2);
  PointMotion motion;
  if (q.moves) motion = [&](const Vec3& x, GlobalIndex, double t) { return waved(x, 0.1 * std::sin(4 * t)); };
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
TEST(HeatOrder, is_second_on_oblique_cells) { check_order("oblique mesh", {.sheared = true}, 1.9); }
/// Cells of random shapes have mean values that are of first order in space, as for the velocity.
TEST(HeatOrder, is_above_one_and_a_half_on_random_cells) {
  check_order("random mesh", {.random = true}, 1.5);
}
TEST(HeatOrder, is_second_on_a_moving_mesh) { check_order("moving mesh", {.moves = true}, 1.9); }
TEST(HeatOrder, is_second_where_conduction_prevails) {
  check_order("conduction", {.moves = true, .conductivity = 0.2}, 1.9);
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

/// The extrapolated flux of a wall that accelerates is not quite the volume that it sweeps, and the difference carries heat.
TEST(HeatBalance, of_a_box_that_is_shaken_is_kept_in_second_order) {
  double lost[2];
  for (int i = 0; i < 2; ++i) {
    FluidParameters p = warm(0.01, 1e-3, 1e-12);
    p.heat->initial_temperature.text = "300+10*x";
    p.time_step = 1;
    p.initial_velocity = {{"0"}, {"0"}};
    all_sides(p, 2, boundary(BoundaryType::interface));
    FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {8, 8, 1}, Vec3::Zero(), Vec3::Ones()),
                   p, [](const Vec3& x, GlobalIndex, double t) {
                     return Vec3(x[0] + 0.1 * std::pow(std::sin(3 * t), 2), x[1], x[2]);
                   });
    const double before = stored(c);
    double open = 0;
    c.run(0.9, 40 << i, [](const Vec3&, double t) { return Vec3(0.3 * std::sin(6 * t), 0, 0); });
    open = stored(c) - sum(MPI_COMM_WORLD, c.state().heat.received);
    lost[i] = std::abs(stored(c) - before) / before;
    EXPECT_LT(std::abs(open), 1e-12 * before);
  }
  const double slope = std::log2(lost[0] / lost[1]);
  printf("heat of a shaken box: lost %.1e, %.1e, slope %.2f\n", lost[0], lost[1], slope);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, 1.9);
  EXPECT_LT(lost[1], 1e-3);
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
  FluidParameters p = warm(0.01, 0.02);
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
  // Fluid that enters through an outlet has the temperature of the outlet.
  p = warm(0.01, 0.02);
  p.boundaries["xmin"] = boundary(BoundaryType::outlet);
  p.boundaries["xmax"] = at(boundary(BoundaryType::outlet, {}, "2"), "310");
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
  FluidCase<2> back(MPI_COMM_WORLD, raw, p);
  back.run(6, 120);
  EXPECT_LT(temperature_error<2>(back, [](const Vec3&) { return 310; }), 1e-6);
}

/// A hot block that a vortex stretches keeps its extremes with bounded convection.
TEST(HeatConvection, bounded_makes_no_new_extremes) {
  for (const auto convection : {central, bounded}) {
    auto c = vortex<2>("x > 0.2 && x < 0.5 && y > 0.3 && y < 0.7 ? 310 : 300", convection,
                       BoxCells::quadrilaterals, 24, 1e-9);
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

/// A channel of height 1 with a developed flow of mean speed 1, Pe = 2 H U/a = 100; Nusselt numbers with 2 H.
struct Plates {
  FluidCase<2> run;
  double conductivity;
  /// Bulk temperature of the column of cells at x, and that of the wall, less the reference.
  std::array<double, 2> at(double x, const std::string& wall) const {
    double carried = 0, passed = 0, on_wall = 0;
    const State<2>& s = run.state();
    const double width = 0.25;
    for (Index c = 0; c < run.mesh().cells.n_owned(); ++c) {
      if (std::abs(s.placement->centre[c][0] - x) > 0.5 * width) continue;
      const double flux = s.u[c][0] * s.placement->volume[c];
      passed += flux, carried += flux * s.heat.temperature[c];
    }
    const Patch& patch = *run.mesh().find_patch(wall);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Index b = f - run.mesh().n_interior;
      if (std::abs(s.placement->boundary_centre[b][0] - x) < 0.5 * width) on_wall += s.heat.boundary[b];
    }
    return {sum(MPI_COMM_WORLD, carried) / sum(MPI_COMM_WORLD, passed), sum(MPI_COMM_WORLD, on_wall)};
  }
  double flux(double x, const std::string& wall) const {
    const Patch& patch = *run.mesh().find_patch(wall);
    double all = 0;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Index b = f - run.mesh().n_interior;
      const State<2>& s = run.state();
      if (std::abs(s.placement->boundary_centre[b][0] - x) < 0.125)
        all += s.heat.flow[b] / s.placement->area[f].norm();
    }
    return sum(MPI_COMM_WORLD, all);
  }
};
Plates plates(const BoundaryParameters& lower, const BoundaryParameters& upper) {
  FluidParameters p = warm(0.02, 0.02, 1e-8);
  p.boundaries["xmin"] = at(boundary(BoundaryType::inlet, {"6*y*(1-y)", "0"}), "301");
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["ymin"] = lower, p.boundaries["ymax"] = upper;
  p.initial_velocity = {{"6*y*(1-y)"}, {"0"}};
  FluidCase<2> c(MPI_COMM_WORLD,
                 make_box(BoxCells::quadrilaterals, {100, 32, 1}, Vec3::Zero(), Vec3(25, 1, 1)), p);
  c.run(75, 25);
  return {std::move(c), 0.02};
}

TEST(Graetz, plates_of_one_temperature_have_the_nusselt_number_of_the_developed_flow) {
  const BoundaryParameters wall = at(boundary(BoundaryType::no_slip), "300");
  const Plates c = plates(wall, wall);
  const double x = 18.125, bulk = c.at(x, "ymin")[0];
  const double nusselt = -c.flux(x, "ymin") * 2 / (0.02 * bulk);
  printf("Graetz, temperature: Nu %.4f (7.5407)\n", nusselt);
  RecordProperty("nusselt", std::to_string(nusselt));
  EXPECT_NEAR(nusselt, 7.5407, 0.005 * 7.5407);
}

TEST(Graetz, a_plate_that_heats_opposite_an_insulated_one_has_its_nusselt_number) {
  BoundaryParameters hot = boundary(BoundaryType::no_slip);
  hot.heat_flux.emplace().text = "0.5";
  const Plates c = plates(hot, boundary(BoundaryType::no_slip));
  const auto [bulk, wall] = c.at(18.125, "ymin");
  const double nusselt = 0.5 * 2 / (0.02 * (wall - bulk));
  printf("Graetz, flux: Nu %.4f (5.3846)\n", nusselt);
  RecordProperty("nusselt", std::to_string(nusselt));
  EXPECT_NEAR(nusselt, 5.3846, 0.005 * 5.3846);
}

/// A cavity with a film, a flux and buoyancy on oblique cells.
FluidParameters in_a_box(HeatParameters::Convection convection) {
  FluidParameters p = fluid_of(1, 0.01, 1e-10, "box");
  p.heat = warm(1, 0.01).heat;
  p.heat->convection = convection;
  p.heat->expansion = 1e-3;
  p.heat->gravity = {0, -10};
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["xmin"].temperature.emplace().text = "350+10*sin(20*t)";
  p.boundaries["ymin"].heat_flux.emplace().text = "0.2*x";
  p.boundaries["xmax"].film.emplace().coefficient.text = "0.1";
  p.boundaries["xmax"].film->ambient.text = "280";
  return p;
}

std::unique_ptr<FluidParticipant<2>> box_run(const FluidParameters& p, MPI_Comm comm = MPI_COMM_WORLD) {
  RawMesh raw;
  if (parallel::comm_rank(comm) == 0) {
    raw = make_box(BoxCells::quadrilaterals, {10, 8, 1}, Vec3::Zero(), Vec3::Ones());
    perturb_interior(raw, 0.15, 5);
  }
  return std::make_unique<FluidParticipant<2>>(distribute(comm, raw), p, FluidContext{}, MotionLink{});
}

TEST(HeatRestart, goes_on_from_a_checkpoint_bit_for_bit_and_alike_on_any_number_of_ranks) {
  for (const auto convection : {central, bounded}) {
    const FluidParameters p = in_a_box(convection);
    const auto first = box_run(p), second = box_run(p), alone = box_run(p, MPI_COMM_SELF);
    take_steps(*first, 0, 4, 0.05);
    support::SavedState(*first).load_into(*second);
    take_steps(*first, 4, 8, 0.05);
    take_steps(*second, 4, 8, 0.05);
    EXPECT_EQ(first->fluid().state().u, second->fluid().state().u);
    const HeatLevel &one = first->fluid().state().heat, &two = second->fluid().state().heat;
    EXPECT_EQ(one.temperature, two.temperature);
    EXPECT_EQ(one.flow, two.flow);
    EXPECT_EQ(one.received, two.received);
    take_steps(*alone, 0, 8, 0.05);
    const auto &cells = first->fluid().mesh(), &all = alone->fluid().mesh();
    std::vector<double> by_id(all.cells.n_global());
    for (Index c = 0; c < all.cells.n_owned(); ++c)
      by_id[all.cell_id[c]] = alone->fluid().state().heat.temperature[c];
    double largest = 0, warmest = 0;
    for (Index c = 0; c < cells.cells.n_owned(); ++c) {
      largest = std::max(largest, std::abs(one.temperature[c] - by_id[cells.cell_id[c]]));
      warmest = std::max(warmest, one.temperature[c]);
    }
    EXPECT_LT(max(MPI_COMM_WORLD, largest), 1e-7);
    EXPECT_GT(max(MPI_COMM_WORLD, warmest), 10);
    EXPECT_LT(apart(*first, *alone), 1e-8);
  }
}

}  // namespace couplet::fluid::test::heat_test
