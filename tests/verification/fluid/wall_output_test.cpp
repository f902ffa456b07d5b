// SPDX-License-Identifier: Apache-2.0
// Series of the walls: force and moment coefficients, shear and y+, against a flow whose numbers are known.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_case.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid::test::wall_output_test {
namespace {

constexpr double rho = 1.3, mu = 0.02, length = 2, pressure = 0.7;

/// u = y between a wall at rest and one that moves, at a uniform pressure: exact on any mesh.
FluidParameters couette() {
  FluidParameters p;
  p.mesh = "box";
  p.dimension = 2;
  p.density = rho;
  p.viscosity = mu;
  p.pressure_tolerance = 1e-13;
  p.initial_velocity = {{"y"}, {"0"}};
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"y", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "0.7");
  p.boundaries["ymin"] = boundary(BoundaryType::no_slip);
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  p.initial_pressure = config::ExpressionText{"0.7"};
  p.output.walls = true;
  return p;
}

CoefficientParameters floor_coefficients() {
  CoefficientParameters c;
  c.patches = {"ymin"};
  c.speed = 3;
  c.area = 0.5;
  c.length = 0.25;
  c.drag = Vec3(2, 0, 0);  // need not be of length 1
  c.centre = Vec3(0.3, 0.4, 0);
  return c;
}

/// Rows of a CSV below its header, by column.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& file, std::string& header) {
  std::ifstream in(file);
  std::getline(in, header);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    rows.emplace_back();
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) rows.back().push_back(std::stod(word));
  }
  return rows;
}

std::filesystem::path run(const FluidParameters& p, const std::string& name, int steps = 3) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("couplet-" + name + "-" + std::to_string(parallel::comm_size(MPI_COMM_WORLD)));
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const mesh::RawMesh raw =
      parallel::comm_rank(MPI_COMM_WORLD) == 0
          ? mesh::make_box(mesh::BoxCells::quadrilaterals, {20, 10, 1}, Vec3::Zero(), Vec3(length, 1, 1))
          : mesh::RawMesh{};
  FluidParticipant<2> fluid(mesh::distribute(MPI_COMM_WORLD, raw), p, FluidContext{"fluid", folder},
                            MotionLink{});
  fluid.initialise();
  for (int i = 0; i < steps; ++i) {
    fluid.begin_step({0.01 * i, 0.01, coupling::Scheme::standalone, i});
    fluid.solve({});
    fluid.accept_step();
    fluid.write_monitors(0.01 * (i + 1));
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return folder;
}

TEST(WallOutput, coefficients_are_forces_and_moments_over_dynamic_pressure_and_area) {
  FluidParameters p = couette();
  p.output.coefficients["floor"] = floor_coefficients();
  p.output.coefficients["turned"] = floor_coefficients();
  p.output.coefficients["turned"].axis = Vec3(0, 0, -2);
  p.output.coefficients["turned"].lift = Vec3(0, -1, 0);
  std::string header;
  const auto rows = rows_of(run(p, "coefficients") / "coefficients.csv", header);
  EXPECT_EQ(header,
            "time [s],floor drag [-],floor lift [-],floor moment [-],turned drag [-],turned lift [-],turned "
            "moment [-]");
  ASSERT_EQ(rows.size(), 3u);
  const double qa = 0.5 * rho * 9 * 0.5;
  const double drag = mu * length, lift = -pressure * length;
  const double moment = 0.4 * drag - pressure * (length * length / 2 - 0.3 * length);
  for (const auto& row : rows) {
    EXPECT_NEAR(row[1], drag / qa, 1e-10);
    EXPECT_NEAR(row[2], lift / qa, 1e-10);
    EXPECT_NEAR(row[3], moment / (qa * 0.25), 1e-10);
    EXPECT_NEAR(row[4], row[1], 1e-14);
    EXPECT_NEAR(row[5], -row[2], 1e-14);
    EXPECT_NEAR(row[6], -row[3], 1e-14);
  }
}

TEST(WallOutput, shear_and_wall_units_of_a_laminar_run) {
  std::string header;
  const auto rows = rows_of(run(couette(), "walls") / "walls.csv", header);
  EXPECT_THAT(header, ::testing::HasSubstr("ymin mean shear [Pa],ymin largest shear [Pa],ymin mean y+ [-]"));
  ASSERT_EQ(rows.size(), 3u);
  // du/dy = 1: tau = mu; y+ = y (tau/rho)^(1/2) / nu at the first centre, y = 0.05 m
  const double yplus = 0.05 * std::sqrt(mu / rho) / (mu / rho);
  for (const auto& row : rows)
    for (const int wall : {0, 1}) {
      EXPECT_NEAR(row[1 + 4 * wall], mu, 1e-9);
      EXPECT_NEAR(row[2 + 4 * wall], mu, 1e-9);
      EXPECT_NEAR(row[3 + 4 * wall], yplus, 1e-6);
      EXPECT_NEAR(row[4 + 4 * wall], yplus, 1e-6);
    }
}

TEST(WallOutput, is_not_written_unless_asked_for) {
  FluidParameters p = couette();
  p.output.walls = false;
  const auto folder = run(p, "nothing", 1);
  EXPECT_TRUE(std::filesystem::exists(folder / "forces.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "walls.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "coefficients.csv"));
}

TEST(WallOutput, coefficients_of_what_is_no_wall_are_refused_by_name) {
  FluidParameters p = couette();
  p.output.coefficients["floor"] = floor_coefficients();
  p.output.coefficients["floor"].patches = {"xmin"};
  try {
    run(p, "refused", 0);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("output.coefficients.floor.patches: 'xmin' is not a wall"));
  }
}

}  // namespace
}  // namespace couplet::fluid::test::wall_output_test
