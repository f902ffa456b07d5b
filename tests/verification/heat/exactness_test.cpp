// SPDX-License-Identifier: Apache-2.0
// What conduction must reproduce to round-off on any mesh.
#include "common/mesh/distributed/mesh_block.hpp"
#include "tests/support/apart.hpp"
#include "tests/verification/heat/support.hpp"

namespace couplet::testing::exactness_test {
using namespace mesh;

const HeatProperties steel{7850, 50.0, 480.0};

RawMesh distorted_box(BoxCells cells) {
  RawMesh raw = make_box(cells, {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
  perturb_interior(raw, 0.25, 11);
  return raw;
}

class Exactness : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Heat, Exactness,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

// Temperature, flux and convection on different sides.
TEST_P(Exactness, a_linear_temperature_is_exact_under_all_conditions) {
  const int dim = dimension_of(GetParam());
  const Vec3 slope(30, -20, dim == 3 ? 10 : 0);
  const auto exact = [&](const Vec3& x) { return 300 + slope.dot(x); };
  const std::string field = fmt::format("300 + 30*x - 20*y + {}*z", slope[2]);
  HeatParameters p = steady();
  for (const std::string& name : box_patches(dim))
    p.boundaries[name] = heat_boundary(HeatType::temperature, field);
  p.boundaries["xmax"] = heat_boundary(HeatType::flux, fmt::format("{}", 50 * slope[0]));
  // k dT/dn = h (T_inf - T)
  p.boundaries["ymin"] = convection("25", fmt::format("{} - 50*({})/25", field, slope[1]));
  HeatCase scene(distorted_box(GetParam()), {steel}, p);
  scene.step(1);
  const double error = scene.largest_error(exact) / 30;
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  EXPECT_LT(error, 1e-10);
}

TEST_P(Exactness, a_symmetry_plane_is_the_middle_of_the_mirrored_solid) {
  const int dim = dimension_of(GetParam());
  HeatParameters p = steady();
  p.boundaries["ymin"].type = p.boundaries["ymax"].type = HeatType::symmetry;
  if (dim == 3) p.boundaries["zmin"].type = HeatType::symmetry;
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "300");
  p.boundaries["xmax"] = heat_boundary(HeatType::temperature, "400");
  HeatCase scene(distorted_box(GetParam()), {steel}, p);
  scene.step(1);
  EXPECT_LT(scene.largest_error([](const Vec3& x) { return 300 + 100 * x[0]; }), 1e-8);
}

TEST_P(Exactness, heat_is_neither_lost_nor_made_while_properties_depend_on_the_temperature) {
  const int dim = dimension_of(GetParam());
  const HeatProperties varying{7850, fv::Property({"table(T, 300, 60, 600, 30)"}, "k"),
                               fv::Property({"table(T, 300, 450, 400, 500, 600, 700)"}, "c")};
  for (const HeatScheme scheme : {HeatScheme::euler, HeatScheme::three_point, HeatScheme::trapezoidal}) {
    HeatParameters p;
    p.scheme = scheme;
    p.tolerance = 1e-12;
    p.initial_temperature = {"400 + 100*sin(3*x)*y"};
    p.boundaries["xmax"] = heat_boundary(HeatType::flux, "2e4");
    HeatCase scene(distorted_box(GetParam()), {varying}, p);
    const double before = scene.heat->stored_heat();
    for (int i = 0; i < 4; ++i) scene.step(50);
    const double area = dim == 3 ? 0.8 * 0.6 : 0.8;
    // The three-point scheme weighs a steady inflow right from its Euler start on; the others always do.
    const double gained = scene.heat->stored_heat() - before, given = 2e4 * area * 200;
    EXPECT_NEAR(gained / given, 1, scheme == HeatScheme::three_point ? 1e-9 : 1e-9) << int(scheme);
  }
}

// Volume over the surface that carries heat is 1/2 m; at 400 K on average c = 700 J/(kg K): 3 kg/m^3 * 700 / 2^2 = 525 s.
TEST(SteadyHeat, tells_the_time_that_it_neglects_by_the_mean_temperature) {
  HeatParameters p;
  p.analysis = HeatParameters::Analysis::steady;
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "300");
  p.boundaries["xmax"] = heat_boundary(HeatType::temperature, "500 + t");
  HeatCase scene(make_box(BoxCells::quadrilaterals, {8, 2, 1}, Vec3::Zero(), Vec3(1, 0.1, 0)),
                 {{3, 1.0, fv::Property({"table(T, 300, 500, 800, 1500)"}, "c")}}, p);
  std::vector<std::string> said;
  scene.doubts(2, 1, {}, &said);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(
      said[0].find(
          "heat needs about 5.3e+02 s to spread through the solid, but the temperature changes within 1.9e+02 s"),
      std::string::npos)
      << said[0];
}

TEST_P(Exactness, ranks_agree_with_one_rank) {
  const int dim = dimension_of(GetParam());
  HeatParameters p;
  p.initial_temperature = {"350 + 40*cos(2*x)*y"};
  p.source = {"1e6*sin(3*x + y)*(1 + t)"};
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "300 + 10*y + t");
  p.boundaries["xmax"] = convection("100 + t", "320*(1 + x*y)");
  p.boundaries["ymin"].type = HeatType::symmetry;
  if (dim == 3) p.boundaries["zmax"] = heat_boundary(HeatType::flux, "1e4*x");
  const HeatProperties varying{7850, fv::Property({"table(T, 300, 60, 600, 30)"}, "k"), 480.0};
  HeatCase together(distorted_box(GetParam()), {varying}, p);
  HeatCase alone(distorted_box(GetParam()), {varying}, p, MPI_COMM_SELF);
  for (int i = 0; i < 3; ++i) together.step(20), alone.step(20);
  std::vector<double> by_id(alone.mesh().cells.n_owned());
  for (Index c = 0; c < alone.mesh().cells.n_owned(); ++c)
    by_id[alone.mesh().cell_id[c]] = alone.temperature(c);
  double gap = 0;
  for (Index c = 0; c < together.mesh().cells.n_owned(); ++c)
    gap = std::max(gap, std::abs(together.temperature(c) - by_id[together.mesh().cell_id[c]]));
  gap = parallel::max(MPI_COMM_WORLD, gap) / 350;
  ::testing::Test::RecordProperty("gap", fmt::format("{:.3e}", gap));
  EXPECT_LT(gap, 1e-10);
}

// Two materials that meet in an oblique plane: T linear in each, k dT/dn the same on both sides.
TEST_P(Exactness, a_piecewise_linear_temperature_is_exact_across_an_oblique_interface) {
  const int dim = dimension_of(GetParam());
  const double slant = 0.3, k_left = 2, k_right = 50;
  RawMesh raw = make_box(GetParam(), {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double x = 0;
    for (const Index v : raw.cell_points[c]) x += raw.points[v][0] / double(raw.cell_points[c].size());
    raw.cell_zone[c] = x > 0.6;
  }
  raw.zones = {"left", "right"};
  raw.materials = {{"left"}, {"right"}};
  const std::vector<Vec3> before = raw.points;
  perturb_interior(raw, 0.2, 5);
  for (std::size_t p = 0; p < raw.points.size(); ++p) {
    if (std::abs(before[p][0] - 0.6) < 1e-9) raw.points[p] = before[p];
    raw.points[p][0] += slant * (raw.points[p][1] + 0.5 * raw.points[p][2]);
  }
  const Vec3 n = Vec3(1, -slant, dim == 3 ? -0.5 * slant : 0).normalized(), on_plane(0.6, 0, 0);
  const Vec3 left(30, -20, dim == 3 ? 10 : 0), right = left + (k_left / k_right - 1) * n.dot(left) * n;
  const auto exact = [&](const Vec3& x) {
    return 300 + (n.dot(x - on_plane) > 0 ? right : left).dot(x - on_plane);
  };
  const auto linear = [&](const Vec3& g) {
    return fmt::format("({:.17g} + {:.17g}*x + {:.17g}*y + {:.17g}*z)", -g.dot(on_plane), g[0], g[1], g[2]);
  };
  HeatParameters p = steady();
  for (const std::string& name : box_patches(dim))
    p.boundaries[name] =
        heat_boundary(HeatType::temperature,
                      fmt::format("300 + ({} > 0 ? {} : {})", linear(n), linear(right), linear(left)));
  p.boundaries["xmax"] = heat_boundary(HeatType::flux, fmt::format("{:.17g}", k_right * n.dot(right)));
  HeatCase scene(raw, {{1000, k_left, 800.0}, {7850, k_right, 480.0}}, p);
  ASSERT_FALSE(scene.mesh().twin.empty());
  scene.step(1);
  const double error = scene.largest_error(exact) / 30;
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  EXPECT_LT(error, 1e-10);
}

/// Layers of different conductivity along x on a box with straight cells.
struct Layers {
  RawMesh raw;
  std::vector<HeatProperties> materials{{1000, 1.0, 800.0}, {7850, 50.0, 480.0}, {140, 0.05, 900.0}};
  explicit Layers(BoxCells cells) {
    raw = make_box(cells, {6, 2, 2}, Vec3::Zero(), Vec3(0.6, 0.2, 0.2));
    raw.zones = {"brick", "steel", "foam"};
    for (Index c = 0; c < raw.cell_points.size(); ++c) {
      double x = 0;
      for (const Index v : raw.cell_points[c]) x += raw.points[v][0] / double(raw.cell_points[c].size());
      raw.cell_zone[c] = x < 0.2 ? 0 : x < 0.4 ? 1 : 2;
    }
  }
  static double resistance() { return 0.2 / 1 + 0.2 / 50 + 0.2 / 0.05; }
};

TEST(LayeredSlab, the_flux_through_layers_is_exact) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::hexahedra}) {
    const Layers layers(cells);
    HeatParameters p = steady();
    p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "500");
    p.boundaries["xmax"] = convection("10", "300");
    HeatCase scene(layers.raw, layers.materials, p);
    scene.step(1);
    const double area = dimension_of(cells) == 2 ? 0.2 : 0.04;
    const double flux = 200 / (Layers::resistance() + 0.1) * area;
    double error = 0;
    for (const PatchHeat& patch : scene.heat->patch_heat()) {
      if (patch.patch == "xmin") error = std::max(error, std::abs(patch.heat / flux - 1));
      if (patch.patch == "xmax") error = std::max(error, std::abs(patch.heat / flux + 1));
    }
    ::testing::Test::RecordProperty(fmt::format("relative_error_{}", int(cells)),
                                    fmt::format("{:.3e}", error));
    EXPECT_LT(error, 1e-10);
  }
}

// Two bars of 1 m with 10 W/(m K) and 100 K between their ends: 500 W.
TEST(TouchingBars, conduct_heat_where_they_are_tied) {
  MeshBlock block = block_of(MPI_COMM_WORLD,
                             support::beside(make_box(BoxCells::hexahedra, {2, 2, 2}, {0, 0, 0}, {1, 1, 1}),
                                             make_box(BoxCells::hexahedra, {2, 2, 2}, {1, 0, 0}, {2, 1, 1})));
  block.tie = true;
  HeatParameters p = steady();
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "300");
  p.boundaries["xmax"] = heat_boundary(HeatType::temperature, "400");
  HeatCase scene(load_block(MPI_COMM_WORLD, std::move(block), "two bars", 1), {{1000, 10.0, 500.0}}, p);
  scene.step(1);
  EXPECT_LT(scene.largest_error([](const Vec3& x) { return 300 + 50 * x[0]; }), 1e-8);
  for (const PatchHeat& patch : scene.heat->patch_heat()) {
    if (patch.patch == "xmin") EXPECT_NEAR(patch.heat, -500, 1e-7);
    if (patch.patch == "xmax") EXPECT_NEAR(patch.heat, 500, 1e-7);
  }
}

TEST(HeatBoundaries, a_steady_temperature_without_level_is_refused) {
  EXPECT_THAT(
      [] {
        HeatCase scene(make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3(1, 1, 0)), {steel},
                       steady());
      },
      ::testing::ThrowsMessage<Error>(
          ::testing::HasSubstr("a steady temperature is undetermined without a level")));
}

TEST(HeatBoundaries, a_wrong_patch_name_is_reported) {
  HeatParameters p;
  p.boundaries["x-min"] = heat_boundary(HeatType::temperature, "300");
  EXPECT_THAT(
      [&] {
        HeatCase scene(make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3(1, 1, 0)), {steel},
                       p);
      },
      ::testing::ThrowsMessage<Error>(::testing::AllOf(
          ::testing::HasSubstr("heat.boundaries.x-min: the mesh has no patch with this name"),
          ::testing::HasSubstr("Did you mean 'xmin'?"))));
}

}  // namespace couplet::testing::exactness_test
