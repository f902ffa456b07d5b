// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing {
namespace {

/// A folder that all ranks share; rank 0 removes it at the end.
class SharedFolder {
 public:
  SharedFolder() {
    const bool root = comm_rank(MPI_COMM_WORLD) == 0;
    const GlobalIndex process = sum(MPI_COMM_WORLD, GlobalIndex(root ? getpid() : 0));
    path_ = std::filesystem::temp_directory_path() / fmt::format("couplet-solid-output-{}", process);
    if (root) std::filesystem::create_directories(path_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  ~SharedFolder() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(path_);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  std::istringstream in(line);
  for (std::string word; std::getline(in, word, ',');) numbers.push_back(std::stod(word));
  return numbers;
}

/// A sheet pulled by 100 MPa * t in plane stress between symmetry planes: u = (s x, -0.3 s y), s = sigma / E.
SolidParameters pulled_sheet() {
  SolidParameters p = box_parameters(2);
  p.plane = SolidParameters::Plane::stress;
  p.boundaries["xmin"] = boundary(Type::symmetry);
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {"1e8*t", "0"});
  p.probes["corner"].point = Vec3(2, 1, 0);
  p.probes["inside"].point = Vec3(0.731, 0.377, 0);
  return p;
}

TEST(SolidOutput, probes_and_reactions_hold_the_displacement_and_the_balance_of_each_step) {
  const SharedFolder folder;
  RawMesh raw = make_box(BoxCells::triangles, {6, 4, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  perturb_interior(raw, 0.2, 2);
  Solid solid(distribute(MPI_COMM_WORLD, raw), pulled_sheet(), SolidContext{"solid", folder.path()});
  for (int i = 0; i < 3; ++i) {
    step(solid, 1);
    solid.write_monitors(solid.state().time);
    solid.write_output(solid.state().time, i);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (comm_rank(MPI_COMM_WORLD) != 0) return;
  const auto probes = lines_of(folder.path() / "probes.csv");
  ASSERT_EQ(probes.size(), 4u);
  EXPECT_EQ(probes[0], "time [s],corner x [m],corner y [m],inside x [m],inside y [m]");
  const double s = 3e8 / 200e9;
  const std::vector<double> expected{3, 2 * s, -0.3 * s, 0.731 * s, -0.3 * 0.377 * s};
  const std::vector<double> last = numbers_of(probes[3]);
  ASSERT_EQ(last.size(), expected.size());
  for (std::size_t i = 0; i < last.size(); ++i) EXPECT_NEAR(last[i], expected[i], 1e-12);

  const auto reactions = lines_of(folder.path() / "reactions.csv");
  ASSERT_EQ(reactions.size(), 4u);
  EXPECT_EQ(reactions[0], "time [s],xmin x [N],xmin y [N],ymin x [N],ymin y [N],load x [N],load y [N]");
  const std::vector<double> forces = numbers_of(reactions[3]);
  EXPECT_NEAR(forces[1], -3e8, 1);
  EXPECT_NEAR(forces[5], 3e8, 1);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "solid.xdmf"));

  const auto solver = lines_of(folder.path() / "solver.csv");
  ASSERT_EQ(solver.size(), 4u);
  EXPECT_EQ(solver[0], "time [s],solves,iterations,inner iterations,residual");
  EXPECT_EQ(numbers_of(solver[3])[1], 1);
}

TEST(SolidOutput, left_out_effects_are_judged_by_numbers) {
  SolidParameters p = pulled_sheet();
  p.probes.clear();
  p.boundaries["xmax"] = boundary(Type::traction, {"1e8*t^2", "0"});
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {6, 4, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  const auto slow = make_solid(raw, p), fast = make_solid(raw, p);
  for (int i = 0; i < 3; ++i) {
    step(*slow, 1);
    step(*fast, 1e-4);
  }
  EXPECT_THAT(slow->judge_left_out_effects(),
              ::testing::ElementsAre(::testing::HasSubstr("leaving it out was sound"),
                                     ::testing::AllOf(::testing::HasSubstr("inertia left out (static)"),
                                                      ::testing::HasSubstr("leaving it out was sound"))));
  EXPECT_THAT(fast->judge_left_out_effects(),
              ::testing::Contains(::testing::HasSubstr("use 'analysis: dynamic'")));
}

}  // namespace
}  // namespace couplet::testing
