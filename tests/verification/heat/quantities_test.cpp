// SPDX-License-Identifier: Apache-2.0
// Quantities of interest of steady heat: what the dual problem says of their errors, beside the true ones.
#include "solid_solver/output/quantities.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/io/checkpoint.hpp"
#include "solid_solver/diagnostics/view.hpp"
#include "tests/verification/heat/support.hpp"

namespace couplet::testing::quantities_test {
using namespace mesh;

struct Cells {
  const char* name;
  BoxCells kind;
};
constexpr std::array all_cells{
    Cells{"quadrilaterals", BoxCells::quadrilaterals}, Cells{"triangles", BoxCells::triangles},
    Cells{"hexahedra", BoxCells::hexahedra}, Cells{"tetrahedra", BoxCells::tetrahedra}};

using Wanted = std::map<std::string, SolidQuantity>;

SolidQuantity temperature_at(std::vector<double> point) {
  SolidQuantity q;
  q.point = std::move(point), q.field = "temperature";
  return q;
}
SolidQuantity heat_through(std::string patch) {
  SolidQuantity q;
  q.field = "heat", q.patch = std::move(patch);
  return q;
}

/// A unit box with an exact temperature, and numbers of it.
struct Scene {
  std::string name;
  HeatParameters parameters;
  Wanted wanted;
  std::map<std::string, double> exact;
};

Scene sheet_with(const std::string& name, const std::string& formula) {
  Scene scene{name, steady(), {}, {}};
  for (const std::string& patch : box_patches(2))
    scene.parameters.boundaries[patch] = heat_boundary(HeatType::temperature, formula);
  return scene;
}

Scene harmonic() {
  Scene scene = sheet_with("harmonic", "sin(pi*x)*sinh(pi*y)/sinh(pi)");
  scene.wanted = {{"middle", temperature_at({0.5, 0.5})},
                  {"aside", temperature_at({0.31, 0.67})},
                  {"below", heat_through("ymin")}};
  scene.exact = {{"middle", std::sinh(M_PI / 2) / std::sinh(M_PI)},
                 {"aside", std::sin(0.31 * M_PI) * std::sinh(0.67 * M_PI) / std::sinh(M_PI)},
                 {"below", -2 / std::sinh(M_PI)}};
  return scene;
}

Scene heated() {
  Scene scene = sheet_with("source", "0");
  scene.parameters.source = {"2*pi^2*sin(pi*x)*sin(pi*y)"};
  scene.wanted = {{"middle", temperature_at({0.5, 0.5})}, {"side", heat_through("xmin")}};
  scene.exact = {{"middle", 1}, {"side", -2}};
  return scene;
}

/// exp(x) cos(y) with a film on one side and a given flux on another.
Scene film() {
  Scene scene = sheet_with("film", "exp(x)*cos(y)");
  scene.parameters.boundaries["xmax"] = convection("2", "exp(1)*cos(y)*1.5");
  scene.parameters.boundaries["ymax"] = heat_boundary(HeatType::flux, "-exp(x)*sin(1)");
  scene.wanted = {{"edge", temperature_at({1, 0.5})},
                  {"film", heat_through("xmax")},
                  {"cold", heat_through("xmin")},
                  {"given", heat_through("ymax")}};
  scene.exact = {{"edge", std::exp(1) * std::cos(0.5)},
                 {"film", std::exp(1) * std::sin(1)},
                 {"cold", -std::sin(1)},
                 {"given", -(std::exp(1) - 1) * std::sin(1)}};
  return scene;
}

Scene block() {
  Scene scene{"block", steady(), {}, {}};
  for (const std::string& patch : box_patches(3))
    scene.parameters.boundaries[patch] =
        heat_boundary(HeatType::temperature, "sin(pi*x)*sin(pi*y)*sinh(sqrt(2)*pi*z)/sinh(sqrt(2)*pi)");
  scene.wanted = {{"middle", temperature_at({0.5, 0.5, 0.5})}, {"below", heat_through("zmin")}};
  const double s = std::sqrt(2) * M_PI;
  scene.exact = {{"middle", std::sinh(s / 2) / std::sinh(s)},
                 {"below", -s / std::sinh(s) * 4 / (M_PI * M_PI)}};
  return scene;
}

std::vector<QuantityEstimate> found(MPI_Comm comm, const RawMesh& raw, const Scene& scene) {
  HeatCase here(raw, {{1, 1.0, 1.0}}, scene.parameters, comm);
  here.step(1);
  return estimate_heat_quantities(*here.heat, scene.wanted);
}

RawMesh box(BoxCells cells, int n) {
  const int dim = dimension_of(cells);
  return make_box(cells, {n, n, dim == 3 ? n : 1}, Vec3::Zero(), Vec3(1, 1, dim - 2));
}

TEST(HeatQuantities, err_within_a_factor_of_two_of_what_is_estimated_in_most_cases) {
  int near = 0, all = 0;
  for (const auto& [name, cells] : all_cells)
    for (const Scene& scene :
         dimension_of(cells) == 2 ? std::vector{harmonic(), heated(), film()} : std::vector{block()})
      for (const int n : {8, 16})
        for (const QuantityEstimate& q : found(MPI_COMM_WORLD, box(cells, n), scene)) {
          const double wrong = std::abs(scene.exact.at(q.name) - q.value), ratio = q.error() / wrong;
          fmt::print("{} {} {} {}: {:.5g}, true error {:.2g}, estimated {:.2g}, ratio {:.2f}\n", name, n,
                     scene.name, q.name, q.value, wrong, q.error(), ratio);
          // Heat that is given has no error.
          near += (ratio > 0.5 && ratio < 2) || wrong < 1e-9 * std::abs(q.value), all += 1;
          // Small by chance: what is estimated is small, too.
          EXPECT_TRUE((ratio > 0.2 && ratio < 5) || wrong < 1e-4 * std::abs(q.value))
              << name << " " << scene.name << " " << q.name;
        }
  fmt::print("{} of {} within a factor of 2\n", near, all);
  RecordProperty("near", near);
  RecordProperty("all", all);
  EXPECT_GT(near, 0.8 * all);
}

TEST(HeatQuantities, of_linear_fields_have_no_error_on_any_cells) {
  for (const auto& [name, cells] : all_cells) {
    Scene scene{"linear", steady(), {}, {}};
    for (const std::string& patch : box_patches(dimension_of(cells)))
      scene.parameters.boundaries[patch] = heat_boundary(HeatType::temperature, "300+40*x-20*y");
    scene.parameters.boundaries["xmax"] = convection("5", "348-20*y");
    scene.wanted = {{"inside", temperature_at({0.4, 0.3})},
                    {"through", heat_through("xmin")},
                    {"film", heat_through("xmax")}};
    if (dimension_of(cells) == 3) scene.wanted["inside"] = temperature_at({0.4, 0.3, 0.6});
    for (const QuantityEstimate& q : found(MPI_COMM_WORLD, box(cells, 4), scene))
      EXPECT_LT(q.error(), 1e-7 * std::abs(q.value)) << name << " " << q.name;
  }
}

TEST(HeatQuantities, are_the_same_on_any_ranks) {
  for (const auto& [name, cells] : all_cells)
    for (const Scene& scene :
         dimension_of(cells) == 2 ? std::vector{heated(), film()} : std::vector{block()}) {
      const RawMesh raw = box(cells, 5);
      const auto here = found(MPI_COMM_WORLD, raw, scene), alone = found(MPI_COMM_SELF, raw, scene);
      for (std::size_t i = 0; i < alone.size(); ++i) {
        EXPECT_NEAR(here[i].value, alone[i].value, 1e-9) << name << " " << alone[i].name;
        EXPECT_NEAR(here[i].local, alone[i].local, 1e-6 * alone[i].error()) << name << " " << alone[i].name;
        EXPECT_NEAR(here[i].dual, alone[i].dual, 1e-6 * alone[i].error()) << name << " " << alone[i].name;
      }
    }
}

// One layer of hexahedra between planes of symmetry, and the sheet that it stands for.
TEST(HeatQuantities, of_a_layer_between_planes_of_symmetry_are_those_of_the_sheet) {
  constexpr int n = 8;
  Scene layer = film();
  for (const char* side : {"zmin", "zmax"}) layer.parameters.boundaries[side].type = HeatType::symmetry;
  layer.wanted["edge"] = temperature_at({1, 0.5, 0.05});
  const auto sheet = found(MPI_COMM_WORLD, box(BoxCells::quadrilaterals, n), film());
  const auto cut =
      found(MPI_COMM_WORLD, make_box(BoxCells::hexahedra, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 0.1)), layer);
  ASSERT_EQ(cut.size(), sheet.size());
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const double depth = sheet[i].unit == "W" ? 0.1 : 1;
    EXPECT_NEAR(cut[i].value, depth * sheet[i].value, 1e-6 * std::abs(sheet[i].value)) << sheet[i].name;
    EXPECT_GE(cut[i].error(), 0.5 * depth * sheet[i].error()) << sheet[i].name;
    EXPECT_LE(cut[i].error(), 2 * depth * sheet[i].error()) << sheet[i].name;
  }
}

/// Quarter of a ring of radii 7 and 18.625; in 3-D with its ends in planes of symmetry.
RawMesh ring(BoxCells cells, int across, int around) {
  const int dim = dimension_of(cells);
  RawMesh raw = make_box(cells, {across, around, dim == 3 ? 2 : 1}, Vec3::Zero(), Vec3(1, M_PI / 2, dim - 2));
  for (Vec3& x : raw.points) {
    const double r = 7 * std::pow(18.625 / 7, x[0]);
    x = Vec3(r * std::cos(x[1]), r * std::sin(x[1]), x[2]);
  }
  return raw;
}

// 100 K or 100 W/m^2 at the inside, 0 K or a film outside. The boundary of the mesh is a polygon, whose area and distance from the
// probes are wrong by more than the operator.
TEST(HeatQuantities, see_that_a_curved_boundary_is_made_of_chords) {
  const double wide = std::log(18.625 / 7);
  for (const auto& [name, cells] : all_cells)
    for (const auto& [across, around] : {std::pair{16, 6}, {16, 12}}) {
      Scene given{"given", steady(), {{"between", temperature_at({9.9 * M_SQRT1_2, 9.9 * M_SQRT1_2})}}, {}};
      for (const char* side : {"ymin", "ymax", "zmin", "zmax"})
        if (side[0] == 'y' || dimension_of(cells) == 3)
          given.parameters.boundaries[side].type = HeatType::symmetry;
      if (dimension_of(cells) == 3) given.wanted["between"].point.push_back(0.5);
      Scene flux = given;
      given.parameters.boundaries["xmin"] = heat_boundary(HeatType::temperature, "100");
      given.parameters.boundaries["xmax"] = heat_boundary(HeatType::temperature, "0");
      given.exact["between"] = 100 * std::log(18.625 / 9.9) / wide;
      flux.name = "flux", flux.wanted["inside"] = heat_through("xmin");
      flux.parameters.boundaries["xmin"] = heat_boundary(HeatType::flux, "100");
      flux.parameters.boundaries["xmax"] = convection("100", "0");
      flux.exact = {{"between", 700 / 1862.5 + 700 * std::log(18.625 / 9.9)}, {"inside", M_PI / 2 * 700}};
      for (const Scene& scene : {given, flux})
        for (const QuantityEstimate& q : found(MPI_COMM_WORLD, ring(cells, across, around), scene)) {
          const double ratio = q.error() / std::abs(scene.exact.at(q.name) - q.value);
          fmt::print("{} {}x{} {} {}: {:.5g} for {:.5g}, estimated over true error {:.2f}\n", name, across,
                     around, scene.name, q.name, q.value, scene.exact.at(q.name), ratio);
          EXPECT_GT(ratio, q.name == "inside" ? 0.9 : 0.4) << name << " " << scene.name << " " << q.name;
          EXPECT_LT(ratio, q.name == "inside" ? 1.15 : 2) << name << " " << scene.name << " " << q.name;
        }
    }
}

std::string refused(const Scene& scene) {
  HeatCase here(box(BoxCells::triangles, 2), {{1, 1.0, 1.0}}, scene.parameters);
  return support::error_of([&] { check_heat_quantities(*here.heat, scene.wanted); });
}

TEST(HeatQuantities, of_unknown_patches_or_places_outside_are_refused_before_the_run) {
  Scene scene = harmonic();
  EXPECT_EQ(refused(scene), "");
  scene.wanted = {{"heat", heat_through("ymni")}};
  EXPECT_THAT(refused(scene), ::testing::HasSubstr("the mesh has no patch 'ymni'"));
  scene.wanted = {{"spot", temperature_at({2, 2})}};
  EXPECT_NE(refused(scene), "");
}

// What a run of conduction says of its own error, against a mode of a slab.

// A slab |x| < 1, convection Bi = 1 on its faces, z tan z = Bi: the slowest mode, exp(-z^2 Fo) cos(z x), which nothing disturbs.
constexpr double z = 0.8603335890193797;
double cooled(double x, double fo) { return std::exp(-z * z * fo) * std::cos(z * x); }
const double mean_before = std::sin(z) / z;

struct Outcome {
  diagnostics::ErrorParts parts;
  double wrong = 0;  ///< true error over the size of the variation
};

HeatParameters cooling(HeatScheme scheme) {
  HeatParameters p;
  p.scheme = scheme;
  p.initial_temperature = {"cos(0.8603335890193797*x)"};
  p.boundaries["xmin"].type = HeatType::symmetry;
  p.boundaries["xmax"] = convection("1", "0");
  return p;
}

/// n cells, so many steps; with `again` the estimate goes on from its state after every step.
Outcome slab(int n, int steps, HeatScheme scheme, bool again = false) {
  const HeatParameters p = cooling(scheme);
  HeatCase scene(make_box(BoxCells::quadrilaterals, {n, 4, 1}, Vec3::Zero(), Vec3(1, 0.4, 0)),
                 {{1, 1.0, 1.0}}, p);
  diagnostics::Made errors = heat_error(*scene.heat);
  diagnostics::Report report;
  for (int i = 0; i < steps; ++i) {
    const HeatState& now = scene.heat->accepted();
    scene.heat->solve({now.time, 0.5 / steps, coupling::Scheme::standalone, now.steps});
    scene.heat->accept_step();
    errors->observe(report);
    if (!again) continue;
    io::StateInMemory state;
    io::CheckpointWriter writer(state);
    io::Archive saved(writer);
    errors->visit(saved);
    errors = heat_error(*scene.heat);
    io::CheckpointReader reader(state);
    io::Archive loaded(reader);
    errors->visit(loaded);
  }
  const double size = scene.error([](const Vec3&) { return mean_before; });
  errors->conclude(report);
  return {report.errors, scene.error([](const Vec3& x) { return cooled(x[0], 0.5); }) / size};
}

TEST(HeatError, coarse_cells_dominate_where_they_do) {
  const Outcome found = slab(4, 200, HeatScheme::trapezoidal);
  fmt::print("mesh {:.2e}, step {:.2e}, true {:.2e}\n", found.parts.mesh, found.parts.step, found.wrong);
  EXPECT_GT(found.parts.mesh, 10 * found.parts.step);
  EXPECT_GT(found.parts.mesh, found.wrong / 4);
  EXPECT_LT(found.parts.mesh, found.wrong * 4);
}

TEST(HeatError, long_steps_dominate_where_they_do) {
  for (const HeatScheme scheme : {HeatScheme::euler, HeatScheme::three_point, HeatScheme::trapezoidal}) {
    const Outcome found = slab(80,
                               scheme == HeatScheme::euler         ? 20
                               : scheme == HeatScheme::three_point ? 8
                                                                   : 4,
                               scheme);
    fmt::print("scheme {}: mesh {:.2e}, step {:.2e}, true {:.2e}\n", int(scheme), found.parts.mesh,
               found.parts.step, found.wrong);
    EXPECT_GT(found.parts.step, 3 * found.parts.mesh) << int(scheme);
    EXPECT_GT(found.parts.step, found.wrong / 4) << int(scheme);
    EXPECT_LT(found.parts.step, found.wrong * 4) << int(scheme);
  }
}

TEST(HeatError, a_run_that_goes_on_says_the_same) {
  const diagnostics::ErrorParts whole = slab(8, 12, HeatScheme::three_point).parts,
                                stopped = slab(8, 12, HeatScheme::three_point, true).parts;
  EXPECT_EQ(whole.step, stopped.step);
  EXPECT_EQ(whole.mesh, stopped.mesh);
}

/// Hardly a cell a rank: all must agree when the swing is told.
TEST(HeatSwing, is_told_once_on_any_number_of_ranks) {
  HeatParameters p;
  p.scheme = HeatScheme::trapezoidal;
  p.initial_temperature = {"0"};
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "1");
  HeatCase scene(make_box(BoxCells::quadrilaterals, {4, 1, 1}, Vec3::Zero(), Vec3(1, 0.25, 0)),
                 {{1, 1.0, 1.0}}, p);
  EXPECT_EQ(scene.doubts(40, 1000), 1);
}

TEST(HeatError, a_linear_field_errs_nowhere_and_one_temperature_says_nothing) {
  HeatParameters p = steady();
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "300");
  p.boundaries["xmax"] = heat_boundary(HeatType::temperature, "400");
  for (const bool level : {false, true}) {
    if (level) p.boundaries["xmax"].value = {"300"};
    HeatCase scene(make_box(BoxCells::quadrilaterals, {6, 3, 1}, Vec3::Zero(), Vec3(1, 1, 0)),
                   {{1, 1.0, 1.0}}, p);
    scene.step(1);
    diagnostics::Report report;
    heat_error(*scene.heat)->conclude(report);
    const diagnostics::ErrorParts& parts = report.errors;
    if (level) {
      EXPECT_FALSE(parts.known());
    } else {
      EXPECT_LT(parts.mesh, 1e-8);
      EXPECT_TRUE(std::isnan(parts.step));
    }
  }
}

}  // namespace couplet::testing::quantities_test
