// SPDX-License-Identifier: Apache-2.0
// Geometry files written against the sandbox of gmsh: see README.md.
#include <cctype>

#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/gmsh/sandbox.hpp"
#include "common/mesh/load.hpp"
#include "tests/fuzz/mutate.hpp"

namespace couplet::fuzz::geo_fuzz {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// Around quotes, comments and the characters between.
std::string in_text(const std::string& p, Dice& dice) {
  const std::vector<std::string> ways{p,
                                      "s = \"//\"; " + p,
                                      "s = '/*'; " + p + " t = '*/';",
                                      "// \" \n" + p + " // \"",
                                      "/* \" */ " + p + " /* \" */",
                                      "s = \"'\"; " + p + " // '",
                                      "// hidden \r" + p,
                                      "/* open " + p,
                                      "s = \"open; " + p,
                                      "s = \"" + std::string(1100, 'x') + "; " + p + "\";",
                                      "s = \"a\\\"; " + p + " // \\\"\";",
                                      "\xEF\xBB\xBF" + p,
                                      std::string("x = 1;\0", 7) + p,
                                      "// \\\n" + p,
                                      "/**/" + replaced(p, " ", "/**/"),
                                      "/*/ " + p + " /*/",
                                      "/* /* */ " + p + " /* */",
                                      replaced(p, " ", "\n"),
                                      replaced(p, " ", "\f"),
                                      replaced(p, " ", "\t\r\n"),
                                      replaced(p, "\"", "'"),
                                      lower(p),
                                      std::string(20000, ' ') + p,
                                      replaced(p, "S", "\xD0\x85"),
                                      replaced(p, "Sys", "Sys/**/"),
                                      "x = 3 /" + p};
  return dice.of(ways);
}

/// Around statements.
std::string in_statements(const std::string& p, Dice& dice) {
  const std::vector<std::string> ways{p,
                                      "If (0)\n s = \"EndIf\"; t = \"\n" + p + "\n\";\nEndIf",
                                      "If (0)\n EXEndIf2 = 1; " + p + "\nEndIf",
                                      "If (1)\n" + p + "\nElse\n x = 1;\nEndIf",
                                      "Macro hidden\n" + p + "\nReturn\nCall hidden;",
                                      "Macro hidden\n" + p + "\nReturn\nCall Str(\"hidden\");",
                                      "For i In {1:2} x = i; " + p + " EndFor",
                                      "For i In {1:1}\n" + p + "\nEndFor",
                                      "nonsense nonsense; " + p,
                                      "x = (1; " + p,
                                      "Extrude {0, 0, 1} { Surface{1}; " + p + " }",
                                      "Physical Curve(\"a\"; " + p,
                                      "DefineConstant [ n = {1, Name \"x\"} ]; " + p,
                                      "DefineConstant [ n = {1, Name \"x\"; " + p + " } ];",
                                      "Point(1) = {0, 0, 0, 1}\n" + p,
                                      "x = 1; y = 2; " + p + " z = 3",
                                      "Field[1] = MathEval; Field[1].F = \"x\"; " + p,
                                      "Delete { Surface{1}; } " + p};
  return dice.of(ways);
}

/// Statements that run a command, write or read a file elsewhere, or set what would: each leaves, or is meant to leave, a
/// file in the folder `outside`.
std::vector<std::string> payloads(const std::filesystem::path& outside) {
  const std::string pwned = (outside / "pwned").string(), touch = "\"touch " + pwned + "\"";
  const auto file = [&](const char* end) { return "\"" + pwned + end + "\""; };
  return {"SystemCall " + touch + ";",
          "NonBlockingSystemCall " + touch + ";",
          "System " + touch + ";",
          "OnelabRun(\"a\", " + touch + ");",
          "OnelabRun " + touch + ";",
          "Printf(\"x\") > " + file("") + ";",
          "Printf(\"x %g\", 1) >> " + file("") + ";",
          "s = " + file("") + "; Printf(\"x\") > s;",
          "Printf(\"%n%n%n%n\");",
          "Printf(\"%s\", 1);",
          "f = \"%n\"; Printf(f);",
          "x = Sprintf(\"%9999g\", 1);",
          "Save " + file(".msh") + ";",
          "Print " + file(".msh") + ";",
          "CreateDir " + file("") + ";",
          "Mesh 2; Save " + file(".msh") + ";",
          "Field[1] = ExternalProcess; Field[1].CommandLine = " + touch + "; Background Field = 1;",
          "Field[1] = Structured; Field[1].FileName = " + file("") + "; Background Field = 1;",
          "Field[1] = PostView; Background Field = 1;",
          "Field[1] = MathEval; Field[1].CommandLine = " + touch + ";",
          "General.TmpFileName = \"/../../../../../../.." + pwned + "\";",
          "General.ErrorFileName = " + file("") + "; General.SaveOptions = 1;",
          "General.SessionFileName = " + file("") + "; General.SaveSession = 1;",
          "General.TextEditor = " + touch + ";",
          "Solver.Executable0 = " + touch + "; OnelabRun(\"GetDP\");",
          "Print.PostGamma = 1;",
          "PostProcessing.AnimationDelay = 1;",
          "Mesh.PartitionTopologyFile = 1;",
          "Mesh.Format = 10;",
          "Mesh.Algorithm = " + file("") + ";",
          "View \"x\" { SP(0,0,0){1}; }; Save View[0] " + file(".pos") + ";",
          "Plugin(HomologyComputation).Filename = " + file("") + "; Plugin(HomologyComputation).Run;",
          "Plugin(ExtractElements).Run;",
          "SetNumber(\"General.SaveOptions\", 1);",
          "SetString(\"General.TmpFileName\", " + file("") + ");",
          "SyncModel; Save " + file(".msh") + ";",
          "Merge \"program.py\";",
          "Merge \"views.pos\";",
          "Merge \"options.opt\";",
          "Merge \"other.geo_unrolled\";",
          "Merge \"fake.msh\";",
          "Merge \"fake.vtk\";",
          "Merge \"packed.gz\";",
          "Merge " + file(".geo") + ";",
          "MergeWithBoundingBox \"views.pos\";",
          "Include " + file(".geo") + ";",
          "Include \"../outside/pwned.geo\";",
          "Include \"link.geo\";",
          "Include \"linked/pwned.geo\";",
          "Include StrCat(\"views\", \".pos\");",
          "s = \"views.pos\"; Include s;",
          "v = ShapeFromFile(StrCat(\"a\", \".step\"));",
          "s = StrCat(\"System\", \"Call\"); S2N[s] " + touch + ";",
          "StringToName[\"SystemCall\"] " + touch + ";",
          "DefineConstant [ a = {1, GmshOption \"General.SaveOptions\"} ];",
          "DefineConstant [ a = {1, Name \"Gmsh/Action\"} ];",
          "DefineConstant [ a = {1, Name \"x\", Macro " + touch + "} ];",
          "s = \"Gmsh/Action\"; DefineConstant [ a = {1, Name s} ];",
          "DefineConstant [ a = {1, Name StrCat(\"Gm\", \"sh/Action\")} ];",
          "DefineString(\"x\", Name \"Gmsh/Action\");",
          "x = GetEnv(\"HOME\");",
          "x() = ListFromFile(\"/etc/passwd\");",
          "x = GetString(\"Gmsh/Action\");",
          "x = CurrentDirectory; Printf(x);",
          "Macro \"hidden\"\n x = 1;\nReturn\n",
          "Slide({1}, " + file("") + ", " + touch + ");",
          "Levelset Plane(1) = {0, 0, 0, 1};",
          "Parametric Surface(1) = \"x\" \"y\" \"z\";",
          "Color Red { Surface{1}; }",
          "Unheard " + touch + ";",
          "Unheard(" + touch + ");",
          "Unheard { Surface{1}; }",
          "Unheard;",
          "Unheard 3;",
          "Exit;",
          "Abort;"};
}

/// A payload in one of the ways in which a guard that reads otherwise than gmsh would pass it: behind comments, quotes,
/// branches, macros, files, other characters. Files it needs are written to `folder`.
std::string disguise(const std::string& payload, const std::filesystem::path& folder, Dice& dice) {
  std::string inner = dice.one_in(2) ? in_text(payload, dice) : payload;
  inner = in_statements(inner, dice);
  if (dice.one_in(4)) inner = in_text(inner, dice);
  if (dice.one_in(6)) {
    write_file(folder / "inner.geo", inner + "\n");
    inner = dice.one_in(2) ? "Include \"inner.geo\";" : "Merge \"inner.geo\";";
  }
  return inner + (dice.one_in(8) ? "" : "\n");
}

using namespace mesh;
namespace fs = std::filesystem;

const std::string square =
    "Point(1) = {0,0,0,1}; Point(2) = {1,0,0,1}; Point(3) = {1,1,0,1}; Point(4) = {0,1,0,1};\n"
    "Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,4}; Line(4) = {4,1};\n"
    "Curve Loop(1) = {1:4}; Plane Surface(1) = {1};\n"
    "Physical Curve(\"around\") = {1:4}; Physical Surface(\"inside\") = {1};\n";

/// A case folder, a folder beside it where nothing may appear or go, and a gmsh that notes its starts.
class CraftedGeo : public testing::Test {
 protected:
  void SetUp() override {
    top_ = fs::temp_directory_path() / fmt::format("couplet-crafted-{}", ::getpid());
    fs::remove_all(top_);
    for (const char* name : {"case", "outside", "tmp"}) fs::create_directories(top_ / name);
    write_file(outside() / "pwned.geo", "Error(\"read elsewhere\");\n");
    fs::create_symlink(outside() / "pwned.geo", folder() / "link.geo");
    fs::create_directory_symlink(outside(), folder() / "linked");
    const std::string touch = "SystemCall \"touch " + (outside() / "pwned").string() + "\";\n";
    for (const char* name : {"program.py", "views.pos", "options.opt", "other.geo_unrolled", "fake.msh",
                             "fake.vtk", "packed.gz"})
      write_file(folder() / name, touch);
    setenv("TMPDIR", (top_ / "tmp").c_str(), 1);
    unsetenv("COUPLET_ALLOW_COMMANDS");
  }
  void TearDown() override {
    unsetenv("TMPDIR");
    fs::remove_all(top_);
  }

  fs::path folder() const { return top_ / "case"; }
  fs::path outside() const { return top_ / "outside"; }
  /// What is in the folder for what must not be touched, and in those for temporary files.
  std::vector<std::string> strangers() const {
    std::vector<std::string> found;
    for (const char* name : {"outside", "tmp"})
      for (const auto& entry : fs::directory_iterator(top_ / name)) found.push_back(entry.path().filename());
    for (const auto& entry : fs::directory_iterator(top_))
      if (entry.path().filename().string().find("pwned") != std::string::npos) found.push_back(entry.path());
    return found;
  }
  /// Gives the message about it; "" if it is meshed.
  std::string complaint(const std::string& text) const {
    write_file(folder() / "a.geo", text);
    return support::error_of([&] { fs::remove(mesh_geo(folder() / "a.geo", 2)); });
  }
  void expect_no_harm(const std::string& text) const {
    EXPECT_EQ(complaint(text).find("read elsewhere"), std::string::npos) << text;
    EXPECT_EQ(strangers(), std::vector<std::string>{"pwned.geo"}) << text;
  }

  fs::path top_;
};

TEST_F(CraftedGeo, files_do_no_harm_however_they_are_disguised) {
  if (!Barrier::is_possible()) GTEST_SKIP() << "this kernel has no Landlock";
  const std::vector<std::string> harm = payloads(outside());
  Dice dice(seed());
  double slowest = 0;
  for (std::size_t i = 0; i < count(); ++i) {
    const std::string text = (dice.one_in(2) ? square : "") + disguise(harm[i % harm.size()], folder(), dice);
    const auto start = std::chrono::steady_clock::now();
    expect_no_harm(text);
    slowest =
        std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    ASSERT_FALSE(HasFailure()) << "case " << i;
  }
  EXPECT_LT(slowest, double(longest()));
  RecordProperty("tried", int(count()));
  RecordProperty("slowest", fmt::format("{:.3f}", slowest));
}

TEST_F(CraftedGeo, every_payload_as_it_is_does_no_harm) {
  if (!Barrier::is_possible()) GTEST_SKIP() << "this kernel has no Landlock";
  for (const std::string& payload : payloads(outside())) expect_no_harm(square + payload + "\n");
}

TEST_F(CraftedGeo, a_command_or_a_file_elsewhere_is_an_error_with_what_to_do) {
  if (!Barrier::is_possible()) GTEST_SKIP() << "this kernel has no Landlock";
  const std::vector<std::string> all = payloads(outside());
  for (const std::string& payload :
       {all[0], all[5], all[12], std::string("Include \"../outside/pwned.geo\";")})
    EXPECT_NE(complaint(square + payload + "\n").find("start with --allow-commands"), std::string::npos)
        << payload;
  EXPECT_EQ(complaint(square + "nonsense;\n").find("--allow-commands"), std::string::npos)
      << "another mistake";
}

/// The payloads are none of straw: gmsh does what they say if the user lets it.
TEST_F(CraftedGeo, a_trusted_case_may_do_all_of_it) {
  setenv("COUPLET_ALLOW_COMMANDS", "1", 1);
  const std::vector<std::string> all = payloads(outside());
  for (const std::string& payload : {all[0], all[5], all[7], all[14]}) {
    complaint(square + payload + "\n");
    EXPECT_TRUE(fs::exists(outside() / "pwned")) << payload;
    fs::remove_all(outside() / "pwned");
  }
  unsetenv("COUPLET_ALLOW_COMMANDS");
}

/// Much of gmsh's language that cases need.
TEST_F(CraftedGeo, an_ordinary_geometry_is_meshed) {
  write_file(folder() / "sizes.geo",
             "h = 0.5; // size\nMacro corner\n  p = newp; Point(p) = {x, y, 0, h};\nReturn\n");
  EXPECT_EQ(
      complaint(
          "Include \"sizes.geo\";\r\n/* \" ' */ DefineConstant [ n = {4, Min 1, Max 9, Step 1, Name \"Mesh/n\"}, k = 2 ];\n"
          "x = 0; y = 0; Call corner;\nFor i In {1:3}\n If (i == 1)\n x = 1;\n EndIf\n If (i == 2)\n y = 1;\n EndIf\n"
          "If (i == 3)\n x = 0;\n EndIf\n Call corner;\nEndFor\n"
          "l() = {};\nFor i In {1:4}\n c = newl; Line(c) = {i, i % 4 + 1}; l() += c;\nEndFor\n"
          "Curve Loop(1) = {l()}; Plane Surface(1) = {1}; Transfinite Curve {l(0), l(2)} = n + 1 Using Progression 1.1;\n"
          "Field[1] = Distance; Field[1].CurvesList = {1}; Field[2] = Threshold; Field[2].InField = 1;\n"
          "Field[2].SizeMin = 0.2; Field[2].SizeMax = h; Field[2].DistMin = 0; Field[2].DistMax = 1;\n"
          "Field[3] = MathEval; Field[3].F = \"0.3 + 0.1*x^2\"; Field[4] = Min; Field[4].FieldsList = {2, 3};\n"
          "Background Field = 4; Mesh.MeshSizeMin = 0.05; Geometry.Tolerance = 1e-8;\n"
          "Physical Curve(Sprintf(\"s%g\", 1)) = {l()}; Physical Surface(\"all\", 7) = {1};\n"
          "Printf(\"n = %g of %5.2f\", n, k); MeshSize {:} = h; Characteristic Length { 1 } = 0.1;\n"),
      "");
  EXPECT_EQ(strangers(), std::vector<std::string>{"pwned.geo"});
}

/// gmsh would run what stands beside the file and in the user's home.
TEST_F(CraftedGeo, options_beside_the_file_and_in_the_home_are_not_read) {
  const std::string touch = "SystemCall \"touch " + (outside() / "pwned").string() + "\";\n",
                    home = std::getenv("HOME");
  fs::create_directories(top_ / "home");
  for (const fs::path& file : {folder() / "a.geo.opt", top_ / "home/.gmshrc", top_ / "home/.gmsh-options"})
    write_file(file, touch);
  setenv("HOME", (top_ / "home").c_str(), 1);
  EXPECT_EQ(complaint(square), "");
  EXPECT_EQ(strangers(), std::vector<std::string>{"pwned.geo"});
  setenv("COUPLET_ALLOW_COMMANDS", "1", 1);
  complaint(square + "SyncModel;\n");
  EXPECT_TRUE(fs::exists(outside() / "pwned")) << "they do what they say in a case that is trusted";
  unsetenv("COUPLET_ALLOW_COMMANDS");
  setenv("HOME", home.c_str(), 1);
}

/// gmsh makes in the sandbox what it makes outside: points, curves, their cells, names. All of the project's in the full run, every
/// tenth in the quick one.
TEST_F(CraftedGeo, the_sandbox_changes_no_mesh) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(COUPLET_SOURCE_DIR) / "configs"))
    if (entry.path().extension() == ".geo") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i < files.size(); i += count() < 500 ? 10 : 1) {
    const auto mesh = [&](bool trusted) {
      run_gmsh({"-2"}, files[i], trusted, folder() / "same.0.msh", "mesh");
      return read_file(folder() / "same.0.msh");
    };
    EXPECT_EQ(mesh(false), mesh(true)) << files[i];
  }
}

}  // namespace couplet::fuzz::geo_fuzz
