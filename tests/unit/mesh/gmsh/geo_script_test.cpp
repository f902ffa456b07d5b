// SPDX-License-Identifier: Apache-2.0

#include <sys/stat.h>

#include "common/mesh/gmsh/gmsh.hpp"
#include "tests/support/test.hpp"

namespace couplet::geo_script_test {
using namespace mesh;

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class Geo : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
  GeoScript script(const std::string& text, const std::string& name = "a.geo") {
    std::ofstream(folder / name) << text;
    return read_geo(folder / name);
  }
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("couplet-geo-" + std::to_string(::getpid()));
};

TEST_F(Geo, included_files_belong_to_its_text_each_once) {
  std::filesystem::create_directories(folder / "sub");
  std::ofstream(folder / "sub/c.geo") << "x = 1;\n";
  std::ofstream(folder / "shape.step") << "a shape\n";
  const std::string text =
      "Include \"sub/c.geo\"; // Include \"no.geo\";\nInclude \"sub/../sub/c.geo\";\n"
      "v() = ShapeFromFile(\"shape.step\"); Merge \"missing.msh\";\n";
  EXPECT_EQ(script(text).text, text + "x = 1;\na shape\n");
}

TEST_F(Geo, an_include_with_a_computed_name_is_found) {
  EXPECT_EQ(script("Include \"b.geo\"; Merge 'b.msh'; /* Merge s; */ Merge2 = 1;\n").computed, "");
  const std::string where = "line 2 of '" + (folder / "a.geo").string() + "'";
  EXPECT_EQ(script("x = 1;\nInclude StrCat(\"b\", \".geo\");\n").computed, where);
  EXPECT_EQ(script("s = \"b.geo\";\nMerge s;\n").computed, where);
}

TEST_F(Geo, a_last_line_that_gmsh_would_not_read_is_found) {
  for (const char* text :
       {"x = 1; y = 2;\n", "x = 1;", "x = 1;\n ", "x = 1;\ny = 2;", "x = 1; // y = 2;", "x = 1;  "})
    EXPECT_EQ(script(text).lost, "") << text;
  EXPECT_EQ(script("x = 1;\ny = 2; z = 3;").lost, "line 2 of '" + (folder / "a.geo").string() + "'");
  EXPECT_EQ(script("x = 1; Include \"b.geo\";\n").lost, "");
  script("x = 1; y = 2;", "b.geo");
  EXPECT_EQ(script("x = 1; Include \"b.geo\";\n").lost, "line 1 of '" + (folder / "b.geo").string() + "'");
}

TEST_F(Geo, what_may_have_no_end_is_refused) {
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const auto error = [&](const std::string& text) { return support::error_of([&] { script(text); }); };
  for (const char* text : {"x = 1;\nMerge \"pipe\";\n", "\nInclude 'pipe';\n",
                           "\nField[1].FileName = \"pipe\";\n", "\nMerge \"/dev/urandom\";\n"})
    EXPECT_THAT(error(text),
                AllOf(HasSubstr("The line 2 of '"), HasSubstr("is a device or a pipe and may have no end")))
        << text;
  EXPECT_THAT(error("x = 1;\nSleep 30;\n"),
              HasSubstr("line 2 of '" + (folder / "a.geo").string() + "' makes gmsh wait (Sleep)"));
  EXPECT_EQ(error("Physical Curve(\"Sleep\") = {1}; // Sleep 30;\n"), "");
}

TEST_F(Geo, a_file_that_includes_itself_is_refused) {
  std::ofstream(folder / "b.geo") << "Include \"c.geo\";\n";
  std::ofstream(folder / "c.geo") << "Include \"b.geo\";\n";
  EXPECT_THROW(script("Include \"b.geo\";"), Error);
}

TEST_F(Geo, names_are_found_as_they_stand) {
  const GeoScript s = script(
      "DefineConstant [ n = 8, h = {0.1, Name \"size, or [so]\"} , m ];\n"
      "Physical Curve(\"top\") = {1}; Physical Line(\"bottom\", 7) = {2}; Physical Surface(\"all\") = {1};"
      "Physical Volume(Sprintf(\"v%g\", 1)) = {1}; Extrude {0, 0, h} { Surface{1}; Layers{n / m2}; Layers{m}; }"
      " Transfinite Curve {1, 3} = n2 Using Progression 1.1;");
  EXPECT_EQ(s.counts, (std::map<std::string, bool>{{"m", true}, {"n2", true}}));
  EXPECT_THAT(s.constants, ElementsAre("n", "h", "m"));
  ASSERT_TRUE(s.groups[1] && s.groups[2]);
  EXPECT_THAT(*s.groups[1], ElementsAre("top", "bottom"));
  EXPECT_THAT(*s.groups[2], ElementsAre("all"));
  EXPECT_FALSE(s.groups[3]) << "computed";
}

// A regular expression of the standard library goes one call deeper with each character that it takes: hundreds of kilobytes in one
// go ended the program.
TEST_F(Geo, hundreds_of_kilobytes_of_blanks_comments_names_and_brackets_end_nothing) {
  constexpr std::size_t much = 400000;
  const std::vector<std::tuple<std::string, char, std::string>> texts{
      {"Physical", ' ', "Surface(\"all\") = {1};\n"},
      {"//", 'x', "\nx = 1;\n"},
      {"/*", '*', "*/ x = 1;\n"},
      {"a", 'a', " = 1;\n"},
      {"x = ", '(', ";\n"},
      {"\"", 'q', "\";\n"},
      {"DefineConstant [ n = ", '{', "];\n"}};
  for (const auto& [head, filling, tail] : texts)
    EXPECT_NO_THROW(script(head + std::string(much, filling) + tail)) << head;
  EXPECT_EQ(script("DefineConstant" + std::string(much, ' ') + "[ n = 1 ];\n").constants.size(), 1u);
}

TEST_F(Geo, the_dimension_of_a_mesh_is_that_of_its_groups_however_they_are_written) {
  const std::string square =
      "Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};\n"
      "Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Transfinite Curve {1:4} = 3;\n"
      "Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface {1}; Recombine Surface {1};\n"
      "Physical Curve(\"side\") = {1:4};\n// Physical Volume is for others\nPhysical" +
      std::string(400000, ' ') + "Surface(\"all\") = {1};\n";
  script(square, "square.geo");
  const MeshFacts facts = facts_of_file(folder / "square.geo", {}, 1);
  EXPECT_EQ(facts.dim, 2);
  EXPECT_EQ(facts.cells, 4u);
}

}  // namespace couplet::geo_script_test
