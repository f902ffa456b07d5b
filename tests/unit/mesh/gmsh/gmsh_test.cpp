// SPDX-License-Identifier: Apache-2.0
// Universal files, MED, Exodus, SU2 and Nastran, read by a Python script. data/groups.med and .exo: two cubes, one on the other, written by
// meshio 5.0; sides.exo: the same with named blocks and sets of sides, written by netCDF4 1.6; groups.unv: as Salome writes it;
// shells.exo: a cube with blocks of shells on two faces, one of them in a set of sides; prisms.su2: written by gmsh.
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
std::map<std::string, double> sizes_of(const std::filesystem::path& file, int dim = 3) {
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, read_mesh(MPI_COMM_SELF, file, dim));
  std::map<std::string, double> sizes;
  for (const Patch& patch : mesh.patches)
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      sizes[patch.name] += geometry.face_area[f].norm();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) sizes[mesh.zones[mesh.cell_zone[c]]] += geometry.volume[c];
  return sizes;
}

auto near(const char* name, double size) { return ::testing::Pair(name, ::testing::DoubleNear(size, 1e-9)); }

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

TEST(Foreign, exodus_blocks_of_shells_name_only_faces_that_no_set_of_sides_has) {
  ::testing::internal::CaptureStdout();
  EXPECT_THAT(sizes_of(test::data / "shells.exo"),
              UnorderedElementsAre(std::pair("solid", 1), std::pair("left", 1), std::pair("right", 1),
                                   std::pair("lid", 1), std::pair("rest", 3)));
  EXPECT_THAT(::testing::internal::GetCapturedStdout(),
              HasSubstr("in sets or smaller groups, which name them: skin"));
}

TEST(Foreign, su2_markers_are_patches) {
  EXPECT_THAT(sizes_of(test::data / "prisms.su2"),
              UnorderedElementsAre(near("left", 2), near("right", 2), near("sides", 6), near("default", 2)));
  const test::TemporaryFolder folder;
  const auto plane = folder.write(
      "plane.SU2",
      "% two cells\nNDIME=2\nNPOIN= 5 5\n0 0 0\n1 0 1\n1 1 2\n0 1 3\n2 1 4\nNELEM= 2\n9 0 1 2 3 0\n5 1 4 2 1 % last\n"
      "NMARK= 2\nMARKER_TAG= wall\nMARKER_ELEMS= 2\n3 0 1\n3 1 4\nMARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 1\n1 0\n");
  EXPECT_THAT(sizes_of(plane, 2),
              UnorderedElementsAre(near("wall", 1 + std::sqrt(2)), near("rest", 3), near("default", 1.5)));
  EXPECT_THAT(error_of(folder.write("two.su2", "NZONE= 2\n")), HasSubstr("it has several zones"));
}

TEST(Foreign, nastran_properties_and_sets_are_zones_and_patches) {
  const test::TemporaryFolder folder;
  const std::string
      nodes =
          "GRID,1,,0.,0.,0.\nGRID,2,0,1.,0.,0.\nGRID*,3,,1.0D+0,1.\n*,0.\nGRID    4               0.      1.+0\n"
          "GRID*   5                               0.              0.              *\n*       1.0E+0\n"
          "GRID           6              1.     0.0   10.-1\nGRID,7,,1.,1.,1.\nGRID,8,,0.,1.,1.\n",
      head =
          "SOL 101\nSET 7 = 1 THRU 4\n$HMSET  9  2 \"upper,part\"\nSET 9 = 12,\n  99\nBEGIN BULK\n"
          "$ Femap Property 3 : steel\n$HMNAME COMP  4\"skin\"\n";
  const std::string cells =
      "CHEXA   10      3       1       2       3       4       5       6       +A\n+A      7       8\n"
      "CQUAD4,11,4,1,4,8,5\nCQUAD4,12,4,5,6,7,8\nCQUAD4,13,4,1,2,6,5\nPSOLID,3,1\nFORCE,1,2,,1.,1.,0.,0.\nCONM2,20,1,,2.\nENDDATA\n";
  ::testing::internal::CaptureStdout();
  EXPECT_THAT(sizes_of(folder.write("cube.bdf", head + nodes + cells)),
              UnorderedElementsAre(near("steel", 1), near("set_7", 1), near("skin", 2), near("upper_part", 1),
                                   near("rest", 2)));
  EXPECT_THAT(::testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("called by their number: set_7"), HasSubstr("skipped: FORCE, PSOLID"),
                    HasSubstr("1 cards 'CONM2' are not read")));
  EXPECT_THAT(
      sizes_of(folder.write("plane.nas", nodes + "CQUAD4,1,1,1,2,3,4\nCBAR,2,5,1,2\nPLOTEL,3,2,3\n"), 2),
      UnorderedElementsAre(near("property_1", 1), near("property_5", 1), near("rest", 3)));
  EXPECT_THAT(error_of(folder.write("own.bdf", "GRID,1,2,0.,0.,0.\n")),
              HasSubstr("node 1 is in the coordinate system 2"));
  EXPECT_THAT(error_of(folder.write("more.bdf", "INCLUDE 'mesh.bdf'\n")),
              HasSubstr("it includes other files"));
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
                         HasSubstr("sets or smaller groups, which name them: all"),
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
