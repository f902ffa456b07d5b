// SPDX-License-Identifier: Apache-2.0
// MED and Exodus by Python's meshio, where it is installed; else what to install is told. data/groups.med and .exo: two cubes, one
// on the other, written by meshio 5.0.
#include "common/mesh/gmsh/gmsh.hpp"
#include "support.hpp"

namespace couplet::meshio_test {
using namespace mesh;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool has_module(const std::string& names) {
  return std::system(("python3 -c 'import " + names + "' 2>/dev/null").c_str()) == 0;
}

TEST(Meshio, med_groups_are_zones_and_patches) {
  if (gmsh_has("Med")) GTEST_SKIP() << "gmsh reads it itself";
  const auto file = test::data / "groups.med";
  if (!has_module("meshio, numpy, h5py")) {
    EXPECT_THAT(support::error_of([&] { read_mesh(MPI_COMM_SELF, file, 3); }),
                AllOf(HasSubstr("groups.med"), HasSubstr("apt install python3-meshio python3-h5py")));
    return;
  }
  const MeshBlock raw = read_mesh(MPI_COMM_SELF, file, 3);
  EXPECT_THAT(raw.zones, ElementsAre("lower", "upper"));
  EXPECT_THAT(raw.patches, ElementsAre("bottom", "top", "side_s"));
  EXPECT_EQ(raw.points.size(), 12u);
  EXPECT_EQ(distribute(MPI_COMM_SELF, raw).mesh.cells.n_global(), 2);
}

TEST(Meshio, exodus_sets_of_nodes_are_patches) {
  const auto file = test::data / "groups.exo";
  if (!has_module("meshio, numpy, netCDF4")) {
    EXPECT_THAT(support::error_of([&] { read_mesh(MPI_COMM_SELF, file, 3); }),
                AllOf(HasSubstr("groups.exo"), HasSubstr("apt install python3-meshio python3-netcdf4")));
    return;
  }
  const MeshBlock raw = read_mesh(MPI_COMM_SELF, file, 3);
  EXPECT_THAT(raw.patches, ElementsAre("bottom", "top", "rest"));
  EXPECT_EQ(distribute(MPI_COMM_SELF, raw).mesh.cells.n_global(), 2);
}

TEST(Meshio, what_it_cannot_read_is_told_with_its_words) {
  if (!has_module("meshio, numpy, netCDF4")) GTEST_SKIP() << "meshio is not installed";
  const auto file = std::filesystem::temp_directory_path() / fmt::format("couplet-broken-{}.exo", ::getpid());
  std::ofstream(file) << "no mesh";
  EXPECT_THAT(support::error_of([&] { read_mesh(MPI_COMM_SELF, file, 3); }),
              HasSubstr("meshio could not read"));
  std::filesystem::remove(file);
}

}  // namespace couplet::meshio_test
