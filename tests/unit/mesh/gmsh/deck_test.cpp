// SPDX-License-Identifier: Apache-2.0
// Input decks of CalculiX and Abaqus. data/groups.inp was made from data/groups.geo by gmsh 4.8.4.
#include <chrono>

#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/load.hpp"
#include "tests/unit/mesh/support.hpp"

namespace couplet::deck_test {
using namespace mesh;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Decks : public ::testing::Test {
 protected:
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("couplet-inp-{}", ::getpid());
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  RawMesh read(const std::string& text) const { return read_foreign(write("deck.inp", text)); }
  std::string error(const std::string& text) const {
    return support::error_of([&] { read(text); });
  }
};

/// Two cubes, one on the other along z.
const std::string two_cubes =
    "*NODE, NSET=Nall\n1, 0,0,0\n2, 1,0,0\n3, 1,1,0\n4, 0,1,0\n5, 0,0,1\n6, 1,0,1\n7, 1,1,1\n8, 0,1,1\n"
    "15, 0,0,2\n16, 1,0,2\n17, 1,1,2\n18, 0,1,2\n";
const std::string cubes =
    "*ELEMENT, TYPE=C3D8, ELSET=low\n10, 1,2,3,4,5,6,7,8\n*ELEMENT, TYPE=C3D8I, ELSET=high\n20, 5,6,7,8,15,16,17,18\n";

Vec3 area_of(const RawMesh& raw, const std::string& patch) {
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  Vec3 area = Vec3::Zero();
  const Patch* found = mesh.find_patch(patch);
  if (!found) return Vec3::Constant(-1);
  for (Index f = found->first; f < found->first + found->count; ++f) area += geometry.face_area[f];
  return area;
}

TEST_F(Decks, surfaces_and_node_sets_are_patches_and_sections_zones) {
  const RawMesh raw = read(
      "*Heading\r\n two cubes\r\n** a comment\r\n" + two_cubes + cubes +
      "*nset, nset=Floor\n1, 2,\n3, 4\n*Nset, NSET=every, GENERATE\n1, 18\n"
      "*ELSET, ELSET=Both\nlow, HIGH\n*SURFACE, NAME=Side,\nTYPE=ELEMENT\nboth, s3\n20, S4\n"
      "*SURFACE, NAME=lid\n20, S2\n*SOLID SECTION, ELSET=LOW, MATERIAL=steel\n*SOLID  SECTION, elset=high, material=rubber\n1.\n"
      "*STEP\n*STATIC\n1, 1\n*CLOAD\n7, 1, 3.5\n*END STEP\n");
  EXPECT_EQ(raw.dim, 3);
  EXPECT_EQ(raw.cell_type.size(), 2u);
  EXPECT_EQ(raw.points.size(), 12u);
  EXPECT_THAT(raw.zones, ElementsAre("low", "high"));
  EXPECT_THAT(raw.cell_zone, ElementsAre(0, 1));
  EXPECT_THAT(raw.patches, ElementsAre("Side", "lid", "Floor", "rest"));
  EXPECT_EQ(area_of(raw, "Side"), Vec3(1, -2, 0));
  EXPECT_EQ(area_of(raw, "lid"), Vec3(0, 0, 1));
  EXPECT_EQ(area_of(raw, "Floor"), Vec3(0, 0, -1));
  EXPECT_EQ(area_of(raw, "rest"), Vec3(-1, 2, 0));
}

TEST_F(Decks, generated_sets_step_by_one_where_no_step_is_given_and_the_rest_is_unnamed) {
  const RawMesh raw = read(two_cubes + cubes + "*NSET, NSET=lid, GENERATE\n15, 18, 3\n16, 17\n");
  EXPECT_THAT(raw.patches, ElementsAre("lid", "rest"));
  EXPECT_EQ(area_of(raw, "lid"), Vec3(0, 0, 1));
  EXPECT_EQ(area_of(raw, "rest"), Vec3(0, 0, -1));
}

TEST_F(Decks, faces_are_numbered_as_in_the_manuals) {
  const auto normals = [&](const std::string& element, int faces) {
    std::string text = two_cubes + element;
    for (int f = 1; f <= faces; ++f) text += fmt::format("*SURFACE, NAME=face{0}\n1, S{0}\n", f);
    const RawMesh raw = read(text);
    std::vector<Vec3> all;
    for (int f = 1; f <= faces; ++f) all.push_back(area_of(raw, fmt::format("face{}", f)));
    return all;
  };
  EXPECT_THAT(normals("*ELEMENT, TYPE=C3D8R\n1, 1,2,3,4,5,6,7,8\n", 6),
              ElementsAre(Vec3(0, 0, -1), Vec3(0, 0, 1), Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0),
                          Vec3(-1, 0, 0)));
  EXPECT_THAT(normals("*ELEMENT, TYPE=C3D6\n1, 1,2,4,5,6,8\n", 5),
              ElementsAre(Vec3(0, 0, -0.5), Vec3(0, 0, 0.5), Vec3(0, -1, 0), Vec3(1, 1, 0), Vec3(-1, 0, 0)));
  EXPECT_THAT(normals("*ELEMENT, TYPE=C3D4\n1, 1,2,4,5\n", 4),
              ElementsAre(Vec3(0, 0, -0.5), Vec3(0, -0.5, 0), Vec3(0.5, 0.5, 0.5), Vec3(-0.5, 0, 0)));
  EXPECT_THAT(
      normals("*ELEMENT, TYPE=C3D5\n1, 1,2,3,4,5\n", 5),
      ElementsAre(Vec3(0, 0, -1), Vec3(0, -0.5, 0), Vec3(0.5, 0, 0.5), Vec3(0, 0.5, 0.5), Vec3(-0.5, 0, 0)));
  for (const char* type : {"CPE4", "CAX4R", "DC2D4", "DCAX4", "CPS4RT"})
    EXPECT_THAT(normals(fmt::format("*ELEMENT, TYPE={}\n1, 1,2,3,4\n", type), 4),
                ElementsAre(Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0)));
  EXPECT_THAT(normals("*ELEMENT, TYPE=CPS3\n1, 1,2,4\n", 3),
              ElementsAre(Vec3(0, -1, 0), Vec3(1, 1, 0), Vec3(-1, 0, 0)));
}

TEST_F(Decks, elements_of_second_order_give_their_corners_alone) {
  const RawMesh raw = read(
      "*NODE\n1, 0,0,0\n2, 1.0D0,0,0\n3, 0,1,0\n4, 0,0,1\n5, .5,0,0\n6, .5,.5,0\n7, 0,.5,0\n8, 0,0,.5\n9, .5,0,.5\n10, 0,.5,.5\n"
      "99, 7,7,7\n*ELEMENT, TYPE=C3D10, ELSET=body\n5, 1,2,3,4,5,6,7,\n8,9,10\n*NSET, NSET=base\n1,2,3,5,6,7\n");
  EXPECT_EQ(raw.points.size(), 4u);
  EXPECT_EQ(raw.cell_type[0], CellType::tetrahedron);
  EXPECT_THAT(raw.zones, ElementsAre("body"));
  EXPECT_EQ(area_of(raw, "base"), Vec3(0, 0, -0.5));
}

TEST_F(Decks, groups_written_by_gmsh_are_patches) {
  const RawMesh raw = read_foreign(test::data / "groups.inp");
  EXPECT_THAT(raw.patches, ::testing::UnorderedElementsAre("bottom", "top", "sides"));
  EXPECT_EQ(raw.dim, 3);
  EXPECT_NEAR((area_of(raw, "top") - Vec3(0, 0, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR(area_of(raw, "sides").norm(), 0, 1e-12);
}

TEST_F(Decks, included_files_lie_in_the_folder) {
  write("parts/nodes.txt", two_cubes);
  const RawMesh raw = read("*INCLUDE, INPUT=parts/nodes.txt\n" + cubes);
  EXPECT_EQ(raw.cell_type.size(), 2u);
  EXPECT_THAT(raw.zones, ElementsAre("low", "high"));
  EXPECT_THAT(error("*INCLUDE, INPUT=../secret.txt\n"),
              AllOf(HasSubstr("deck.inp:1:"), HasSubstr("outside the folder")));
  EXPECT_THAT(error("*INCLUDE, INPUT=/etc/passwd\n"), HasSubstr("outside the folder"));
  EXPECT_THAT(error("*INCLUDE, INPUT=none.txt\n"), HasSubstr("does not exist"));
  EXPECT_THAT(error("*INCLUDE\n"), HasSubstr("names no file"));
  EXPECT_THAT(error("*INCLUDE, INPUT=parts\n"), HasSubstr("is a folder"));
  EXPECT_THAT(error("*INCLUDE, INPUT=deck.inp\n"), HasSubstr("is nested deeper than 8 files"));
}

TEST_F(Decks, data_lines_may_come_from_other_files) {
  write("parts/high.txt", "20, 5,6,7,8,15,16,17,18\n");
  write("parts/floor.txt", "1, 2\n*\n3\n");
  const RawMesh raw = read(two_cubes +
                           "*ELEMENT, TYPE=C3D8, ELSET=low\n10, 1,2,3,4,5,6,7,8\n"
                           "*ELEMENT, TYPE=C3D8, ELSET=high, INPUT=parts/high.txt\n"
                           "*NSET, NSET=floor\n*include, input=parts/floor.txt\n4\n");
  EXPECT_THAT(raw.zones, ElementsAre("low", "high"));
  EXPECT_EQ(raw.cell_type.size(), 2u);
  EXPECT_EQ(area_of(raw, "floor"), Vec3(0, 0, -1));
}

TEST_F(Decks, sets_may_follow_what_refers_to_them) {
  std::string nodes = two_cubes;
  nodes.replace(nodes.find("1, 0,0,0"), 8, "1");
  const RawMesh raw =
      read("*SOLID SECTION, ELSET=b\n*SURFACE, NAME=lid\nBoth, S2\n*ELSET, ELSET=both\na, b\n" + nodes +
           "*ELEMENT, TYPE=C3D8\n10, 1,2,3,4,5,6,7,8\n20, 5,6,7,8,15,16,17,18\n*\n*ELSET, ELSET=a\n10\n"
           "*ELSET, ELSET=b\n20\n*SOLID SECTION, ELSET=a\n");
  EXPECT_THAT(raw.zones, ElementsAre("b", "a"));
  EXPECT_THAT(raw.cell_zone, ElementsAre(1, 0));
  EXPECT_EQ(area_of(raw, "lid"), Vec3(0, 0, 1));
  EXPECT_EQ(area_of(raw, "rest"), Vec3(0, 0, -1));
  EXPECT_THAT(error("*ELSET, ELSET=a\nb\n*ELSET, ELSET=b\na\n"),
              AllOf(HasSubstr("deck.inp:4:"), HasSubstr("sets contain each other")));
  EXPECT_THAT(error("*SOLID SECTION, ELSET=a\n"),
              AllOf(HasSubstr("deck.inp:1:"), HasSubstr("'a' is neither")));
}

TEST_F(Decks, what_is_not_read_is_named) {
  const auto log_of = [&](const std::string& text) {
    ::testing::internal::CaptureStdout();
    read(two_cubes + cubes + text);
    return ::testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(log_of("*NSET, NSET=a\n1, 2, 3, 101, 102\n"),
              HasSubstr("2 of 5 of NSET 'a' (the first is 101)"));
  EXPECT_THAT(log_of("*ELSET, ELSET=e\n10\n*SURFACE, NAME=s\ne, S1\n30, S2\n31, S2\n"),
              HasSubstr("2 of 3 of SURFACE 's' (the first is 30)"));
  EXPECT_THAT(log_of("*SURFACE, NAME=s, TYPE=NODE\n1\n2\n3\n4\n90\n"),
              HasSubstr("1 of 5 of SURFACE 's' (the first is 90)"));
  EXPECT_THAT(log_of("*ELEMENT, TYPE=MASS\n7, 1\n*ELSET, ELSET=e\n7, 10, 11\n"),
              AllOf(HasSubstr("1 of 3 of ELSET 'e' (the first is 11)"), HasSubstr("skipped: MASS")));
  EXPECT_THAT(log_of("*NSET, NSET=a, GENERATE\n1, 90\n"), ::testing::Not(HasSubstr("not defined")));
  EXPECT_THAT(log_of("*NSET, NSET=a, WEIGHT=2\n1\n"),
              HasSubstr("deck.inp:18: the parameter WEIGHT of *NSET is not read"));
  EXPECT_THAT(log_of("*NSET, NSET=a\n5, 6, 7, 8\n"), HasSubstr("no boundary face is left for them: a."));
  EXPECT_THAT(log_of("*TIE, NAME=t\na, b\n*MATERIAL, NAME=m\n"),
              AllOf(HasSubstr("connected by *TIE, which is not read"), HasSubstr("skipped: *MATERIAL")));
  EXPECT_THAT(error(two_cubes + cubes + "*NSET, NSET=a, ELSET=low\n"), HasSubstr("list the nodes"));
}

TEST_F(Decks, mistakes_are_told_with_file_and_line) {
  EXPECT_THAT(error(""), HasSubstr("no solid elements"));
  EXPECT_THAT(error("1, 2\n"), AllOf(HasSubstr("deck.inp:1:"), HasSubstr("begin with a keyword")));
  EXPECT_THAT(error("*NODE\n1, 0, x, 0\n"), AllOf(HasSubstr("deck.inp:2:"), HasSubstr("'x'")));
  EXPECT_THAT(error("*NODE\n1, 0, 1e999, 0\n"), HasSubstr("deck.inp:2:"));
  EXPECT_THAT(error("*NODE\n-1, 0, 0, 0\n"), HasSubstr("a node needs a whole number above 0"));
  EXPECT_THAT(error("*NODE\n1, 0, 0, 0\n1, 1, 0, 0\n"),
              AllOf(HasSubstr("deck.inp:3:"), HasSubstr("node 1 is defined twice")));
  EXPECT_THAT(error("*NODE, SYSTEM=C\n1, 0, 0, 0\n"), HasSubstr("rectangular"));
  EXPECT_THAT(error(two_cubes + "*ELEMENT, TYPE=S4\n1, 1,2,3,4\n"),
              AllOf(HasSubstr("deck.inp:14:"), HasSubstr("shells")));
  EXPECT_THAT(error(two_cubes + "*ELEMENT\n1, 1,2,3,4\n"), HasSubstr("*ELEMENT needs TYPE=..."));
  EXPECT_THAT(error(two_cubes + "*ELEMENT, TYPE=C3D4\n1, 1,2,3\n"),
              AllOf(HasSubstr("deck.inp:15:"), HasSubstr("expected 5 whole numbers")));
  EXPECT_THAT(error(two_cubes + "*ELEMENT, TYPE=C3D4\n1, 1,2,3,4,5\n"), HasSubstr("found 6 numbers"));
  EXPECT_THAT(error(two_cubes + "*ELEMENT, TYPE=C3D4\n1, 1,2,3,77\n"),
              AllOf(HasSubstr("deck.inp:15:"), HasSubstr("node 77")));
  EXPECT_THAT(error(two_cubes + "*ELEMENT, TYPE=C3D8\n1, 1,2,3,3,5,6,7,7\n"), HasSubstr("node 3 twice"));
  EXPECT_THAT(error(two_cubes + "*ELEMENT, TYPE=C3D4\n1, 1,2,3,5\n1, 1,2,4,5\n"),
              AllOf(HasSubstr("deck.inp:16:"), HasSubstr("defined twice")));
  EXPECT_THAT(error(two_cubes + cubes + "*SURFACE, NAME=a\n10, S7\n"), HasSubstr("'beam, S3'"));
  EXPECT_THAT(error(two_cubes + cubes + "*SURFACE, NAME=a\n10\n"), HasSubstr("'beam, S3'"));
  EXPECT_THAT(error(two_cubes + cubes + "*SURFACE, NAME=a\nnone, S1\n"),
              AllOf(HasSubstr("deck.inp:19:"), HasSubstr("nor the name of an ELSET")));
  EXPECT_THAT(error(two_cubes + cubes + "*SURFACE, NAME=a\n10, S1\n*SURFACE, NAME=b\n10, S1\n"),
              AllOf(HasSubstr("(0.5, 0.5, 0)"), HasSubstr("two surfaces, 'a' and 'b'")));
  EXPECT_THAT(error(two_cubes + "*ELEMENT, TYPE=C3D4, ELSET=e\n1, 1,2,4,5\n*SURFACE, NAME=a\ne, S5\n"),
              HasSubstr("S1 to S4 only"));
  EXPECT_THAT(error(two_cubes + "*NGEN\n1, 2\n"), HasSubstr("it generates nodes"));
  EXPECT_THAT(error("*PART, NAME=a\n*END PART\n*PART, NAME=b\n"), HasSubstr("several parts"));
  EXPECT_THAT(error("*INSTANCE, NAME=a, PART=b\n1, 0, 0\n"),
              HasSubstr("transformed instances are not supported"));
  EXPECT_THAT(error(two_cubes + "*NSET, NSET=a, GENERATE\n5, 1\n"), HasSubstr("first, last and step"));
  EXPECT_THAT(
      error(
          two_cubes + cubes +
          "*SOLID SECTION, ELSET=low\n*SOLID SECTION, ELSET=high\n*ELSET, ELSET=b\n10\n*SOLID SECTION, ELSET=b\n"),
      HasSubstr("has two sections, 'low' and 'b'"));
}

TEST_F(Decks, crafted_sets_cost_neither_memory_nor_time) {
  std::string grows = two_cubes + cubes + "*NSET, NSET=s0\n1\n";
  for (int i = 0; i < 3000; ++i) {
    grows += fmt::format("*NSET, NSET=s{}\n", i + 1);
    for (int k = std::max(0, i - 40); k <= i; ++k) grows += fmt::format("s{}\n", k);
    grows += fmt::format("{}\n", 20 + 3 * i);
  }
  std::string wide = two_cubes + cubes + "*NSET, NSET=s\n";
  for (int i = 0; i < 200000; ++i) wide += fmt::format("{}\n", 1 + 2 * i);
  for (int i = 0; i < 1000; ++i) wide += fmt::format("*NSET, NSET=t{}\ns\n", i);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(error(grows), ::testing::AnyOf(HasSubstr("members"), ::testing::IsEmpty()));
  EXPECT_THAT(error(wide), HasSubstr("members"));
  EXPECT_EQ(error(two_cubes + cubes + "*NSET, NSET=all, GENERATE\n1, 2147483647\n"), "");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

}  // namespace couplet::deck_test
