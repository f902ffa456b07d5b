// SPDX-License-Identifier: Apache-2.0
// Fields on patches and fluxes through them, against flows whose loads are known.
#include "fluid_case.hpp"
#include "fluid_solver/participant.hpp"
#include "tests/support/csv.hpp"
#include "tests/support/surface_file.hpp"

namespace couplet::fluid::test::surfaces_test {
using namespace mesh;

constexpr double rho = 1.3, mu = 0.02, length = 2;
using couplet::testing::SurfaceFile;
using Columns = std::map<std::string, std::vector<double>>;

FluidParameters channel() {
  FluidParameters p = fluid_of(rho, mu, 1e-13, "box");
  p.boundaries["ymin"] = boundary(BoundaryType::no_slip);
  p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "0");
  p.output.surfaces = {"all"};
  p.output.fluxes = true;
  return p;
}

/// u = y between a wall at rest and one that moves, at a uniform pressure: exact on squares.
FluidParameters couette() {
  FluidParameters p = channel();
  p.initial_velocity = {{"y"}, {"0"}};
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"y", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "0.7");
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  p.initial_pressure = config::ExpressionText{"0.7"};
  CoefficientParameters c;
  c.patches = {"ymin"};
  c.speed = 3;
  c.pressure = 0.2;
  p.output.coefficients["floor"] = c;
  return p;
}

class Written {
 public:
  Written(const FluidParameters& p, const std::string& name, int n, const RawMesh& raw, double dt = 0.01) {
    folder_ = std::filesystem::temp_directory_path() /
              ("couplet-surfaces-" + name + "-" + std::to_string(parallel::comm_size(MPI_COMM_WORLD)));
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
      std::filesystem::remove_all(folder_);
      std::filesystem::create_directories(folder_);
    }
    MPI_Barrier(MPI_COMM_WORLD);
    FluidParticipant<2> fluid(
        distribute(MPI_COMM_WORLD, parallel::comm_rank(MPI_COMM_WORLD) == 0 ? raw : RawMesh{}), p,
        FluidContext{"fluid", folder_}, MotionLink{});
    fluid.initialise();
    fluid.write_monitors(0);
    fluid.write_output(0, 0);
    for (int i = 0; i < n; ++i) {
      fluid.begin_step({dt * i, dt, coupling::Scheme::standalone, i});
      fluid.solve({});
      fluid.accept_step();
      fluid.write_monitors(dt * (i + 1));
    }
    fluid.write_output(dt * n, n);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  ~Written() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(folder_);
  }
  const std::filesystem::path& folder() const { return folder_; }
  Columns csv(const std::string& file) const { return support::Csv(folder_ / file).columns(); }
  SurfaceFile surface(const std::string& patch) const { return {folder_, patch}; }

 private:
  std::filesystem::path folder_;
};

RawMesh squares(int nx, int ny, double width = length) {
  return make_box(BoxCells::quadrilaterals, {nx, ny, 1}, Vec3::Zero(), Vec3(width, 1, 1));
}

RawMesh crooked_triangles() {
  RawMesh raw = make_box(BoxCells::triangles, {12, 7, 1}, Vec3::Zero(), Vec3(length, 1, 1));
  perturb_interior(raw, 0.2, 2);
  return raw;
}

TEST(FluidSurfaces, of_a_flow_that_is_exact_on_the_mesh) {
  const Written run(couette(), "couette", 3, squares(20, 10));
  const SurfaceFile floor = run.surface("ymin");
  const auto shear = floor.vectors("cells/wall-shear"), traction = floor.vectors("cells/traction");
  const auto pressure = floor.values("cells/pressure"), yplus = floor.values("cells/y-plus");
  const auto cp = floor.values("cells/pressure-coefficient");
  ASSERT_EQ(floor.size(), 20u);
  for (std::size_t c = 0; c < 20; ++c) {
    EXPECT_LT((shear[c] - Vec3(mu, 0, 0)).norm(), 1e-10);
    EXPECT_LT((traction[c] - Vec3(mu, -0.7, 0)).norm(), 1e-10);  // the floor is pressed down
    EXPECT_NEAR(pressure[c], 0.7, 1e-10);
    EXPECT_NEAR(cp[c], 0.5 / (0.5 * rho * 9), 1e-10);
    EXPECT_NEAR(yplus[c], 0.05 * std::sqrt(mu / rho) / (mu / rho), 1e-6);
  }
  EXPECT_FALSE(run.surface("xmin").has("cells/y-plus"));
  EXPECT_FALSE(run.surface("ymax").has("cells/pressure-coefficient"));  // no coefficients are of it
}

TEST(FluidSurfaces, tractions_times_areas_are_the_forces_of_the_walls) {
  FluidParameters p = couette();
  p.initial_velocity = {{"y + 0.3*sin(3*x)"}, {"0.2*cos(5*y)"}};  // far from steady
  const Written run(p, "sum", 3, crooked_triangles());
  const Columns forces = run.csv("forces.csv");
  for (const std::string wall : {"ymin", "ymax"}) {
    const Vec3 load = run.surface(wall).integral("cells/traction");
    for (const int a : {0, 1}) {
      const std::string axis = a == 0 ? "x" : "y";
      const double force = forces.at(wall + " pressure " + axis + " [N]").back() +
                           forces.at(wall + " viscous " + axis + " [N]").back();
      EXPECT_GT(std::abs(force), 1e-6);
      EXPECT_NEAR(load[a], force, 1e-13 + 1e-12 * std::abs(force)) << wall << axis;
    }
  }
}

/// Momentum that passes through all patches, and volume.
std::array<double, 3> sums(const Columns& fluxes, std::size_t row) {
  std::array<double, 3> total{};
  for (const std::string patch : {"xmin", "xmax", "ymin", "ymax"}) {
    total[0] += fluxes.at(patch + " volume [m^3/s]")[row];
    total[1] += fluxes.at(patch + " momentum x [N]")[row];
    total[2] += fluxes.at(patch + " momentum y [N]")[row];
  }
  return total;
}

TEST(Fluxes, of_a_flow_that_is_exact_on_the_mesh) {
  const Written run(couette(), "couette-fluxes", 3, squares(20, 10));
  const Columns fluxes = run.csv("fluxes.csv");
  ASSERT_EQ(fluxes.at("time [s]").size(), 3u);  // at the start there is no pressure yet
  double carried = 0;
  for (int i = 0; i < 10; ++i) carried += rho * 0.1 * (0.05 + 0.1 * i) * (0.05 + 0.1 * i);
  EXPECT_NEAR(fluxes.at("xmin volume [m^3/s]").back(), -0.5, 1e-12);
  EXPECT_NEAR(fluxes.at("xmax volume [m^3/s]").back(), 0.5, 1e-12);
  EXPECT_NEAR(fluxes.at("xmin momentum x [N]").back(), -carried - 0.7, 1e-9);
  EXPECT_NEAR(fluxes.at("ymin momentum x [N]").back(), mu * length, 1e-9);
  EXPECT_NEAR(fluxes.at("ymin momentum y [N]").back(), -0.7 * length, 1e-9);
  EXPECT_NEAR(fluxes.at("ymax mean pressure [Pa]").back(), 0.7, 1e-10);
  for (const double rest : sums(fluxes, 2)) EXPECT_NEAR(rest, 0, 1e-9);
}

/// The mesh moves at 0.3 m/s along a uniform flow of 1 m/s, so that 0.7 of it pass.
TEST(Fluxes, are_relative_to_a_mesh_that_moves) {
  FluidParameters p = channel();
  p.output.surfaces.clear();
  for (const char* side : {"xmin", "ymin", "ymax"})
    p.boundaries[side] = boundary(BoundaryType::inlet, {"1", "0"});
  p.initial_velocity = {{"1"}, {"0"}};
  p.motion.emplace().translation = {{"0.3*t"}, {"0.1*t"}};
  const Columns fluxes = Written(p, "moved-fluxes", 3, squares(8, 4)).csv("fluxes.csv");
  const std::map<std::string, double> wanted{
      {"xmin", -0.7}, {"xmax", 0.7}, {"ymin", 0.1 * length}, {"ymax", -0.1 * length}};
  for (const auto& [patch, volume] : wanted) {
    EXPECT_NEAR(fluxes.at(patch + " volume [m^3/s]").back(), volume, 1e-11) << patch;
    EXPECT_NEAR(fluxes.at(patch + " momentum x [N]").back(), rho * volume, 1e-9) << patch;
  }
}

TEST(Fluxes, of_a_plane_channel_balance_and_its_walls_carry_the_pressure_drop) {
  FluidParameters p = channel();
  p.viscosity = 1;
  p.initial_velocity = {{"4*y*(1 - y)"}, {"0"}};
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"4*y*(1 - y)", "0"});
  p.output.flow_areas["duct"] = {"xmin", "xmax"};
  p.output.flow_areas["turned"] = {"xmax", "xmin"};
  p.output.flow_areas["walls"] = {"ymin", "ymax"};
  const Written run(p, "poiseuille", 30, squares(16, 12), 0.05);
  const Columns fluxes = run.csv("fluxes.csv");
  const std::size_t last = fluxes.at("time [s]").size() - 1;
  const std::array<double, 3> rest = sums(fluxes, last);
  const double drop = 8 * length;  // -dp/dx = 8 mu U
  EXPECT_NEAR(rest[0], 0, 1e-10);
  EXPECT_NEAR(rest[1], 0, 5e-6 * drop);
  EXPECT_NEAR(rest[2], 0, 5e-6 * drop);
  EXPECT_NEAR(fluxes.at("xmin mean pressure [Pa]")[last] - fluxes.at("xmax mean pressure [Pa]")[last], drop,
              0.04 * drop);
  EXPECT_NEAR(fluxes.at("ymin momentum x [N]")[last] + fluxes.at("ymax momentum x [N]")[last], drop,
              0.04 * drop);
  // The area of an ideal flow, [thesis] eq. (4.35).
  const Columns areas = run.csv("flow-areas.csv");
  const double area = areas.at("duct effective area [m^2]")[last],
               mass = areas.at("duct mass flow [kg/s]")[last];
  EXPECT_NEAR(mass, rho * 2 / 3, 0.01);
  EXPECT_NEAR(area, rho * 2 / 3 / std::sqrt(2 * rho * drop), 0.025 * area);
  EXPECT_NEAR(areas.at("duct pressure drop [Pa]")[last],
              fluxes.at("xmin mean pressure [Pa]")[last] - fluxes.at("xmax mean pressure [Pa]")[last], 1e-9);
  EXPECT_NEAR(areas.at("turned effective area [m^2]")[last], area, 1e-9);
  EXPECT_NEAR(areas.at("turned mass flow [kg/s]")[last], -mass, 1e-9);
  EXPECT_NEAR(areas.at("walls mass flow [kg/s]")[last], 0, 1e-12);
  const auto centres = run.surface("ymax").centres(), shear = run.surface("ymax").vectors("cells/wall-shear");
  for (std::size_t c = 0; c < centres.size(); ++c) {
    const double x = centres[c].x();
    if (x < 0.5 || x > 1.6) continue;         // the scheme's parabola is not that of the inlet
    EXPECT_NEAR(shear[c].x(), 4, 0.06) << x;  // mu dU/dy
  }
}

TEST(Fluxes, between_walls_are_known_to_ranks_without_boundary_faces) {
  FluidParameters p = couette();
  p.initial_velocity = {{"y/3"}, {"0"}};
  for (const char* end : {"xmin", "xmax"}) p.boundaries[end] = boundary(BoundaryType::periodic);
  p.output.surfaces = {"ymin"};
  p.output.coefficients.clear();
  RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 36, 1}, Vec3::Zero(), Vec3(0.25, 3, 1));
  raw.periodic = {{"xmin", "xmax"}};
  const Columns fluxes = Written(p, "couette-of-strips", 2, raw).csv("fluxes.csv");
  EXPECT_NEAR(fluxes.at("ymin momentum x [N]").back(), mu * 0.25 / 3, 1e-9);
}

TEST(Fluxes, areas_between_patches_that_do_not_exist_are_refused) {
  FluidParameters p = channel();
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"1", "0"});
  p.output.flow_areas["valve"] = {"xmin", "xmas"};
  EXPECT_THAT(support::error_of([&] { const Written run(p, "no-such-patch", 1, squares(4, 4), 0.05); }),
              ::testing::HasSubstr("output.flow-areas: the mesh has no faces in the patch 'xmas'"));
}

/// u = (x, -y) towards a floor that moves with it: p = -rho (x^2 + y^2) / 2, on the floor Cp = 1 - x^2 with p_ref = -rho/2, U = 1.
TEST(FluidSurfaces, pressure_coefficient_is_one_where_the_flow_stagnates) {
  FluidParameters p = channel();
  p.initial_velocity = {{"x"}, {"-y"}};
  p.initial_pressure = config::ExpressionText{"-0.65*(x*x + y*y)"};
  p.boundaries["xmin"] = boundary(BoundaryType::symmetry);
  p.boundaries["ymin"] = boundary(BoundaryType::moving_wall, {"x", "0"});
  p.boundaries["ymax"] = boundary(BoundaryType::inlet, {"x", "-y"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "-0.65*(x*x + y*y)");
  CoefficientParameters c;
  c.patches = {"ymin"};
  c.pressure = -0.5 * rho;
  p.output.coefficients["floor"] = c;
  p.output.surfaces = {"ymin"};
  const Written run(p, "stagnation", 10, squares(32, 32, 1));
  const auto centres = run.surface("ymin").centres();
  const auto cp = run.surface("ymin").values("cells/pressure-coefficient");
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cp.size(); ++i) {
    const double x = centres[i].x();
    EXPECT_NEAR(cp[i], 1 - x * x, 0.04) << x;  // the outlet takes the speed half a cell before it
    largest = std::max(largest, cp[i]);
  }
  EXPECT_NEAR(largest, 1, 0.025);
}

TEST(FluidSurfaces, are_not_written_unless_asked_for) {
  FluidParameters p = couette();
  p.output.surfaces.clear();
  p.output.fluxes = false;
  const Written run(p, "nothing", 1, squares(8, 4));
  EXPECT_TRUE(std::filesystem::exists(run.folder() / "forces.csv"));
  for (const auto& file : std::filesystem::directory_iterator(run.folder())) {
    EXPECT_THAT(file.path().filename().string(), ::testing::Not(::testing::StartsWith("surface")));
    EXPECT_NE(file.path().filename(), "fluxes.csv");
  }
}

TEST(FluidSurfaces, of_what_is_no_patch_are_refused_by_name) {
  FluidParameters p = couette();
  p.output.surfaces = {"ymni"};
  EXPECT_THAT(
      support::error_of([&] { const Written run(p, "refused", 0, squares(8, 4)); }),
      ::testing::HasSubstr("output.surfaces: 'ymni' is not a patch of the boundary. Did you mean 'ymin'"));
}

}  // namespace couplet::fluid::test::surfaces_test
