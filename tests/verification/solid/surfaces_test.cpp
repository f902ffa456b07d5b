// SPDX-License-Identifier: Apache-2.0
// Fields on patches and moments of reactions, against solutions that are known.
#include "solid_solver/solid.hpp"
#include "tests/support/csv.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/surface_file.hpp"
#include "tests/verification/solid/loads_support.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::surfaces_test {
using namespace mesh;

/// One step, then all output.
std::unique_ptr<Solid> write(const RawMesh& raw, const SolidParameters& p,
                             const support::SharedFolder& folder) {
  auto solid = std::make_unique<Solid>(
      distribute(MPI_COMM_WORLD, parallel::comm_rank(MPI_COMM_WORLD) == 0 ? raw : RawMesh{}), p,
      SolidContext{"solid", folder.path()});
  step(*solid, 1);
  solid->write_monitors(1);
  solid->write_output(1, 1);
  MPI_Barrier(MPI_COMM_WORLD);
  return solid;
}

class SolidSurfaces : public ::testing::TestWithParam<BoxCells> {
 protected:
  const BoxCells cells = GetParam();
  const int dim = dimension_of(GetParam());
  RawMesh box() const {
    RawMesh raw = make_box(cells, {4, 3, 2}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
    perturb_interior(raw, 0.2, 3);
    return raw;
  }
  double across() const { return dim == 3 ? 0.8 * 0.6 : 0.8; }
};
INSTANTIATE_TEST_SUITE_P(Cells, SolidSurfaces,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra),
                         [](const auto& info) { return name(info.param); });

// sigma_xx = 1e8 everywhere: exact.
TEST_P(SolidSurfaces, of_a_bar_in_tension) {
  const support::SharedFolder folder;
  SolidParameters p = box_parameters(dim);
  p.plane = SolidParameters::Plane::stress;
  for (const char* side : {"xmin", "ymin", "zmin"})
    if (p.boundaries.contains(side)) p.boundaries[side] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {"1e8", "0", "0"});
  p.boundaries["xmax"].value.resize(std::size_t(dim));
  p.output.surfaces = {"all"};
  write(box(), p, folder);
  for (const std::string side : {"xmin", "xmax", "ymin", "ymax"}) {
    const SurfaceFile surface(folder.path(), side);
    const Vec3 wanted = side == "xmax" ? Vec3(1e8, 0, 0) : side == "xmin" ? Vec3(-1e8, 0, 0) : Vec3(0, 0, 0);
    for (const Vec3& traction : surface.vectors("cells/traction"))
      EXPECT_LT((traction - wanted).norm(), 10) << side;
    for (const double stress : surface.values("points/stress-xx")) EXPECT_NEAR(stress, 1e8, 10);
    for (const double stress : surface.values("points/equivalent-stress")) EXPECT_NEAR(stress, 1e8, 10);
    const auto places = surface.points(), moves = surface.vectors("points/displacement");
    for (std::size_t v = 0; v < moves.size(); ++v)  // the points are where they moved to
      EXPECT_NEAR(moves[v].x(), (places[v] - moves[v]).x() * 1e8 / 200e9, 1e-11);
  }
  EXPECT_NEAR(SurfaceFile(folder.path(), "xmax").integral("cells/traction").x(), 1e8 * across(), 1e-3 * 1e8);
}

TEST_P(SolidSurfaces, moments_of_the_reactions_balance_those_of_the_loads) {
  for (const bool symmetric : {false, true}) {
    const support::SharedFolder folder;
    SolidParameters p = box_parameters(dim);
    p.boundaries["xmin"] = clamped(dim);
    if (symmetric) p.boundaries["ymin"] = boundary(Type::symmetry);
    p.boundaries["xmax"] = boundary(Type::traction, {"1e6", "-3e6", "2e6"});
    p.boundaries["xmax"].value.resize(std::size_t(dim));
    p.boundaries["ymax"] = pressed("4e6");
    p.method.preconditioner = MethodParameters::Preconditioner::factors;
    p.output.moments = true;
    const auto solid = write(box(), p, folder);
    const Resultant load = resultant(solid->body().mesh(), solid->body().geometry(), p);
    const auto row = support::Csv(folder.path() / "reactions.csv").columns();
    const auto held = [&](const std::string& what) {
      return row.at("xmin " + what).back() + (symmetric ? row.at("ymin " + what).back() : 0);
    };
    for (const char axis : {'x', 'y', 'z'}) {
      if (dim == 2 && axis != 'z') continue;
      const double moment = load.moment[axis - 'x'];
      EXPECT_GT(std::abs(moment), 1e4);
      EXPECT_NEAR(held(fmt::format("moment {} [N m]", axis)), -moment, 1e-8 * load.moment.norm());
    }
    EXPECT_NEAR(held("x [N]"), -load.force.x(), 1e-8 * load.force.norm());
  }
}

// Lame's cylinder under inner pressure in plane strain.

TEST(SolidSurfaces, of_a_thick_cylinder_under_pressure) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
    const support::SharedFolder folder;
    SolidParameters p = box_parameters(2);
    p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
    p.boundaries["xmin"] = pressed("3e6");
    p.output.surfaces = {"xmin", "ymin"};
    write(quarter_ring(cells, 12, 24), p, folder);
    const double a = 1e6;  // p r_i^2 / (r_o^2 - r_i^2): sigma = a (1 -+ r_o^2 / r^2)
    const SurfaceFile inner(folder.path(), "xmin"), cut(folder.path(), "ymin");
    const auto at = inner.points();
    const auto xx = inner.values("points/stress-xx"), yy = inner.values("points/stress-yy");
    double worst = 0;
    for (std::size_t v = 0; v < at.size(); ++v)
      worst = std::max(worst, std::abs(xx[v] + yy[v] - 2 * a) / (5 * a));
    EXPECT_LT(worst, cells == BoxCells::triangles ? 0.03 : 0.01);
    const auto centres = inner.centres(), push = inner.vectors("cells/traction");
    for (std::size_t c = 0; c < centres.size(); ++c)
      EXPECT_LT((push[c] - 3e6 * centres[c].normalized()).norm(), 1e-3 * 3e6);  // the load itself
    const auto place = cut.centres(), hoop = cut.vectors("cells/traction");
    worst = 0;
    for (std::size_t c = 0; c < place.size(); ++c) {
      const double r = place[c].x();
      worst = std::max(worst, std::abs(hoop[c].y() + a * (1 + 4 / (r * r))) / (5 * a));
    }
    EXPECT_LT(worst, 0.01) << name(cells);
  }
}

// F is uniform: the traction is Cauchy's stress times the normal of the deformed face.
TEST(SolidSurfaces, of_large_strain_carry_the_load_over_the_deformed_area) {
  const support::SharedFolder folder;
  SolidParameters p = box_parameters(3);
  p.material = {1000, 1e6, 0.3};
  p.material.law = "neo-hookean";
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  for (const char* side : {"xmin", "ymin", "zmin"}) p.boundaries[side] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {"5e5", "0", "0"});
  p.output.surfaces = {"xmin", "xmax"};
  write(make_box(BoxCells::hexahedra, {3, 2, 2}, Vec3::Zero(), Vec3(1, 1, 1)), p, folder);
  for (const std::string side : {"xmin", "xmax"}) {
    const SurfaceFile surface(folder.path(), side);
    double area = 0;
    for (const double a : surface.areas()) area += a;
    EXPECT_LT(area, 0.95);  // it grew thinner
    const double sign = side == "xmax" ? 1 : -1;
    EXPECT_LT((surface.integral("cells/traction") - sign * Vec3(5e5, 0, 0)).norm(), 1e-5 * 5e5);
  }
}

TEST(SolidSurfaces, of_a_body_that_conducts_heat) {
  const support::SharedFolder folder;
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::thermal;
  p.material.heat.conductivity = config::ExpressionText{"50"};
  p.material.heat.specific_heat = config::ExpressionText{"500"};
  p.heat.emplace();
  p.heat->analysis = HeatParameters::Analysis::steady;
  p.heat->boundaries["xmin"] = {HeatBoundary::Type::temperature, {"400"}, {}, {}};
  p.heat->boundaries["xmax"] = {HeatBoundary::Type::temperature, {"300"}, {}, {}};
  p.output.surfaces = {"all"};
  RawMesh raw;
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0)
    raw = make_box(BoxCells::triangles, {6, 4, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  ThermalSolid solid(distribute(MPI_COMM_WORLD, raw), p, SolidContext{"solid", folder.path()});
  solid.begin_step({0, 1, coupling::Scheme::standalone, 0});
  solid.solve({});
  solid.accept_step();
  solid.write_output(1, 1);
  MPI_Barrier(MPI_COMM_WORLD);
  const std::map<std::string, double> wanted{{"xmin", 50 * 100 / 2.}, {"xmax", -50 * 100 / 2.}, {"ymin", 0}};
  for (const auto& [side, flux] : wanted) {
    const SurfaceFile surface(folder.path(), side);
    for (const double q : surface.values("cells/heat-flux")) EXPECT_NEAR(q, flux, 1e-6) << side;
    const auto at = surface.points();
    const auto temperature = surface.values("points/temperature");
    for (std::size_t v = 0; v < at.size(); ++v) EXPECT_NEAR(temperature[v], 400 - 50 * at[v].x(), 1e-8);
  }
}

TEST(SolidSurfaces, are_not_written_unless_asked_for_and_only_of_patches) {
  const support::SharedFolder folder;
  SolidParameters p = box_parameters(2);
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"1e6", "0"});
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 2, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  write(raw, p, folder);
  for (const auto& file : std::filesystem::directory_iterator(folder.path()))
    EXPECT_THAT(file.path().filename().string(), ::testing::Not(::testing::StartsWith("surface")));
  EXPECT_EQ(support::Csv(folder.path() / "reactions.csv").columns().count("xmin moment z [N m]"), 0u);
  p.output.surfaces = {"xmim"};
  EXPECT_THAT([&] { make_solid(parallel::comm_rank(MPI_COMM_WORLD) == 0 ? raw : RawMesh{}, p); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr(
                  "output.surfaces: 'xmim' is not a patch of the boundary. Did you mean 'xmin'?")));
}

}  // namespace couplet::testing::surfaces_test
