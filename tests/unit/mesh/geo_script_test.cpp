// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/geo_script.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <tuple>
#include <vector>

#include "common/base/error.hpp"
#include "common/mesh/gmsh/mesh_facts.hpp"

namespace couplet::geo_script_test {
using namespace mesh;
namespace {

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

TEST_F(Geo, commands_and_written_files_are_found) {
  for (const char* text : {"x = 1;\nSystemCall \"touch pwned\";",
                           "NonBlockingSystemCall \"x\";",
                           "systemcall 'x';",
                           "Printf(\"a;b)\", x) > \"file\";",
                           "Printf('x') >> 'file';",
                           "Save \"x.msh\";",
                           "Print \"x.png\";",
                           "CreateDir \"x\";",
                           "OnelabRun(\"a\", \"rm x\");",
                           "Include StrCat(\"b\", \".geo\");",
                           "Merge Str(\"b.geo\");",
                           "s = \"//\"; SystemCall \"x\";",
                           "Field[1] = ExternalProcess;",
                           "General.TmpFileName = \"/../x\";",
                           "Plugin(HomologyComputation).Run;",
                           "Unheard \"x\";",
                           "Unheard 3;",
                           "/* open SystemCall",
                           "x = \"open;",
                           "$x = 1;"})
    EXPECT_NE(script(text).danger, "") << text;
  EXPECT_EQ(script("x = 1;\nSystemCall \"x\";").danger,
            "'SystemCall' in line 2 of " + (folder / "a.geo").string());
  EXPECT_THAT(script("x = 1;\nPlugin(A).Run;").refusal(),
              testing::AllOf(HasSubstr("'Plugin' in line 2 of "),
                             HasSubstr("Allowed are statements for drawing and meshing"),
                             HasSubstr("--allow-commands")));
}

// Each of the files of the project's own cases is let through, and the cleaned text is its own cleaned text.
TEST_F(Geo, every_geometry_of_the_project_is_let_through) {
  std::size_t n = 0;
  for (const char* top : {"configs", "tests"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(TEST_DATA) /
                                                                           "../../../.." / top)) {
      if (entry.path().extension() != ".geo") continue;
      ++n;
      const GeoScript found = read_geo(entry.path());
      EXPECT_EQ(found.danger, "");
      ASSERT_FALSE(found.files.empty());
      EXPECT_EQ(script(found.files.front().text, "again.geo").files.front().text, found.files.front().text)
          << entry.path();
    }
  EXPECT_GE(n, 60u);
}

TEST_F(Geo, files_elsewhere_are_not_read) {
  std::filesystem::create_directories(folder / "case/sub");
  std::ofstream(folder / "b.geo") << "x = 1;\n";
  std::filesystem::create_symlink(folder / "b.geo", folder / "case/link.geo");
  std::filesystem::create_directory_symlink(folder, folder / "case/up");
  for (const char* name : {"../b.geo", "sub/../../b.geo", "link.geo", "up/b.geo", "/etc/passwd"})
    EXPECT_THAT(script(std::string("Include \"") + name + "\";\n", "case/a.geo").danger, HasSubstr(name))
        << name;
  std::ofstream(folder / "case/sub/c.geo") << "x = 1;\n";
  const GeoScript inside = script("Include \"sub/c.geo\";\nInclude \"sub/../sub/c.geo\";\n", "case/a.geo");
  EXPECT_EQ(inside.danger, "");
  ASSERT_EQ(inside.files.size(), 2u) << "the same file once";
  EXPECT_EQ(inside.files[0].text, "Include \"1.geo\" ; \nInclude \"1.geo\" ; \n");
}

TEST_F(Geo, gmsh_gets_no_comments_and_goes_on_at_the_beginning_of_a_line) {
  EXPECT_EQ(script("x=1.5e-3; // one\n/* two\n*/ y+=x;\n").files[0].text, "x = 1.5e-3 ; \n\ny += x ; \n");
  EXPECT_EQ(script("For i In {1:3} x = i; EndFor\n").files[0].text,
            "For i In { 1 : 3 } \nx = i ; EndFor \n\n");
  EXPECT_EQ(script("s = 'a\tb';\n").danger.substr(0, 6), "a text");
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

TEST_F(Geo, an_ordinary_geometry_is_not_suspected) {
  EXPECT_EQ(
      script(
          "// Printf into > a file\nPrintf(\"n = %g\", n);\nIf (n > 3)\n  Point(1) = {0, 0, 0, h};\nEndIf\n"
          "Save_me = 1; Mesh.SaveAll = 0; /* Print \"x\" */ Physical Curve(\"Print\") = {1};")
          .danger,
      "");
}

TEST_F(Geo, included_files_are_looked_into) {
  std::ofstream(folder / "b.geo") << "Include \"c.geo\";\n";
  std::ofstream(folder / "c.geo") << "SystemCall \"x\";\n";
  EXPECT_THAT(script("Include \"b.geo\";").danger, HasSubstr("c.geo"));
  std::ofstream(folder / "b.geo") << "Include \"b.geo\";\n";
  EXPECT_THROW(script("Include \"b.geo\";"), Error) << "a file that includes itself";
}

TEST_F(Geo, names_are_found_as_they_stand) {
  const GeoScript s = script(
      "DefineConstant [ n = 8, h = {0.1, Name \"size, or [so]\"} , m ];\n"
      "Physical Curve(\"top\") = {1}; Physical Line(\"bottom\", 7) = {2}; Physical Surface(\"all\") = {1};"
      "Physical Volume(Sprintf(\"v%g\", 1)) = {1};");
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
  for (const auto& [head, filling, tail] : texts) {
    const bool is_closed = filling != '(' && filling != '{' && filling != 'q';
    EXPECT_EQ(script(head + std::string(much, filling) + tail).danger.empty(), is_closed) << head;
  }
  EXPECT_NE(script("SystemCall" + std::string(much, ' ') + "\"x\";\n").danger, "");
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

}  // namespace
}  // namespace couplet::geo_script_test
