// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/crafted_geo.hpp"

#include <algorithm>
#include <cctype>

namespace couplet::fuzz {
namespace {

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

}  // namespace

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

}  // namespace couplet::fuzz
