// SPDX-License-Identifier: Apache-2.0
// Universal files, MED and Exodus, read by a Python script. data/groups.med and .exo: two cubes, one on the other, written by
// meshio 5.0; sides.exo: the same with named blocks and sets of sides, written by netCDF4 1.6; groups.unv: as Salome writes it.
#include "common/mesh/gmsh/gmsh.hpp"
#include "tests/unit/mesh/support.hpp"

namespace couplet::foreign_test {
using namespace mesh;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

bool has_h5py() {
  return std::system("(python3 -c 'import h5py' || /usr/bin/python3 -c 'import h5py') 2>/dev/null") == 0;
}

std::string error_of(const std::filesystem::path& file) {
  return support::error_of([&] { read_mesh(MPI_COMM_SELF, file, 3); });
}

/// Area of each patch and volume of each zone.
std::map<std::string, double> sizes_of(const std::filesystem::path& file) {
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, read_mesh(MPI_COMM_SELF, file, 3));
  std::map<std::string, double> sizes;
  for (const Patch& patch : mesh.patches)
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      sizes[patch.name] += geometry.face_area[f].norm();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) sizes[mesh.zones[mesh.cell_zone[c]]] += geometry.volume[c];
  return sizes;
}

TEST(Foreign, med_groups_are_zones_and_patches) {
  const auto file = test::data / "groups.med";
  if (!has_h5py()) {
    EXPECT_THAT(error_of(file), AllOf(HasSubstr("groups.med"), HasSubstr("apt install python3-h5py")));
    return;
  }
  EXPECT_THAT(sizes_of(file),
              UnorderedElementsAre(std::pair("lower", 1), std::pair("upper", 1), std::pair("bottom", 1),
                                   std::pair("top", 1), std::pair("side_s", 8)));
}

TEST(Foreign, exodus_sets_of_nodes_are_patches) {
  const auto file = test::data / "groups.exo";
  if (!has_h5py()) {
    EXPECT_THAT(error_of(file), AllOf(HasSubstr("groups.exo"), HasSubstr("apt install python3-h5py")));
    return;
  }
  EXPECT_THAT(sizes_of(file), UnorderedElementsAre(std::pair("block_0", 2), std::pair("bottom", 1),
                                                   std::pair("top", 1), std::pair("rest", 8)));
}

TEST(Foreign, exodus_blocks_are_zones_and_sets_of_sides_patches) {
  EXPECT_THAT(sizes_of(test::data / "sides.exo"),
              UnorderedElementsAre(std::pair("left", 1), std::pair("right", 1), std::pair("x0", 1),
                                   std::pair("x1", 1), std::pair("y0", 2), std::pair("y1", 2),
                                   std::pair("z0", 2), std::pair("rest", 2)));
}

TEST(Foreign, unv_groups_are_zones_and_patches_and_units_are_converted) {
  ::testing::internal::CaptureStdout();
  const auto sizes = sizes_of(test::data / "groups.unv");
  const std::string log = ::testing::internal::GetCapturedStdout();
  ASSERT_EQ(sizes.size(), 7u);
  for (const auto& [name, size] : std::map<std::string, double>{
           {"low", 1}, {"high", 1}, {"floor", 1}, {"lid", 1}, {"east", 2}, {"west", 2}, {"rest", 4}})
    EXPECT_NEAR(sizes.at(name), size, 1e-12) << name;
  EXPECT_THAT(log, AllOf(HasSubstr("lengths are in units of 0.001 m"),
                         HasSubstr("smaller groups, which name them: all"),
                         HasSubstr("1 elements of the type 161 are not read")));
}

TEST(Foreign, what_is_not_read_is_told_in_a_sentence) {
  const test::TemporaryFolder folder;
  for (const char* name : {"broken.unv", "broken.exo"})
    EXPECT_EQ(error_of(folder.write(name, "no mesh")),
              "Cannot read the mesh '" + (folder.path / name).string() + "': " +
                  (std::string(name).ends_with("unv")
                       ? "it has no nodes (dataset 2411), so it is no universal file or not of a mesh."
                       : "it is no Exodus file, which is netCDF."));
  std::ifstream in(test::data / "sides.exo", std::ios::binary);
  std::string text(1500, '\0');
  in.read(text.data(), 1500);
  EXPECT_THAT(error_of(folder.write("cut.exo", text)),
              AllOf(HasSubstr("cut.exo': it is"), ::testing::Not(HasSubstr("Traceback"))));
}

}  // namespace couplet::foreign_test
