// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/config/fixture.hpp"

namespace couplet::override_test {

config::Document document() {
  return config::Document::parse(good + "probes:\n  - {name: tip}\n  - {name: root}\nboundaries: {}\n",
                                 "case.yaml");
}

Parameters read_with(const std::vector<std::string>& assignments) {
  config::Document d = document();
  for (const std::string& assignment : assignments) d.set(assignment);
  Parameters p;
  config::load_or_throw(d, "", declaration(p));
  return p;
}

TEST(Override, replaces_adds_and_reaches_into_lists) {
  EXPECT_DOUBLE_EQ(read_with({"material.youngs-modulus=2 GPa"}).youngs_modulus, 2e9);
  EXPECT_DOUBLE_EQ(read_with({"material.poisson-ratio=0.1"}).poisson_ratio, 0.1);
  EXPECT_EQ(read_with({"probes.1.name=foot"}).probes[1].name, "foot");
  EXPECT_EQ(read_with({"gravity=[0, -9.81]"}).gravity, Vec3(0, -9.81, 0));
  EXPECT_DOUBLE_EQ(read_with({"damping={mass: 3}"}).damping.value().mass, 3);
  EXPECT_DOUBLE_EQ(read_with({"damping={mass: 3}", "damping.mass=4"}).damping.value().mass, 4);
  EXPECT_EQ(read_with({"boundaries.top={type: outlet}"}).boundaries.at("top").type, Boundary::Type::outlet);
  EXPECT_EQ(read_with({"load=a=b"}).load.text, "a=b");
  EXPECT_EQ(read_with({"divisions={nx: 8, ny: 3}", "divisions.nx=16"}).divisions,
            (std::map<std::string, double>{{"nx", 16}, {"ny", 3}}));
  EXPECT_EQ(read_with({"mesh=one.msh", "mesh=two.msh"}).mesh, "two.msh");
  EXPECT_EQ(read_with({"mesh=of #2/one.msh"}).mesh, "of #2/one.msh") << "an argument has no comments";
}

TEST(Override, without_a_value_removes_the_key) {
  EXPECT_FALSE(read_with({"damping={mass: 3}", "damping="}).damping.has_value());
  EXPECT_FALSE(read_with({"damping={mass: 3}", "damping=~"}).damping.has_value());
  EXPECT_DOUBLE_EQ(read_with({"material.poisson-ratio=0.1", "material.poisson-ratio="}).poisson_ratio, 0.3);
  EXPECT_THROW(read_with({"mesh="}), Error) << "it is required";
  EXPECT_THROW(read_with({"damping=null"}), Error) << "there is none, and an empty section would enable it";
}

TEST(Override, leaves_everything_else_as_it_was) {
  const Parameters p = read_with({"material.poisson-ratio=0.1"});
  EXPECT_DOUBLE_EQ(p.youngs_modulus, 5.6e6);
  EXPECT_EQ(p.mesh, "a.msh");
  EXPECT_EQ(p.probes.size(), 2u);
}

TEST(Override, a_wrong_value_is_reported_with_the_option_it_came_from) {
  config::Document d = document();
  d.set("material.poisson-ratio=0.7");
  d.set("material.density=3");
  Parameters p;
  EXPECT_THAT(
      config::load(d, "", declaration(p)),
      testing::ElementsAre("--set material.poisson-ratio=0.7: material.poisson-ratio: 0.7 is out of range; "
                           "expected a value from -1 to 0.5.",
                           "--set material.density=3: material.density: unknown key. Valid keys: "
                           "youngs-modulus, poisson-ratio."));
  EXPECT_EQ(config::where(d, "material.density"), "--set material.density=3: material.density");
  EXPECT_EQ(config::where(d, "material.youngs-modulus"), "case.yaml:2:12: material.youngs-modulus");
}

TEST(Override, a_path_that_leads_nowhere_is_refused) {
  const auto error_of = [](const std::string& assignment) {
    try {
      document().set(assignment);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error_of("material.poissons-ratio=null"),
              testing::StartsWith(
                  "--set material.poissons-ratio=null: there is no 'material.poissons-ratio' to remove."));
  EXPECT_EQ(error_of("mesh"), "--set mesh: expected key=value, for example --set simulation.end-time='2 s'.");
  EXPECT_EQ(error_of("=3"), "--set =3: expected key=value, for example --set simulation.end-time='2 s'.");
  EXPECT_EQ(error_of("a..b=3"), "--set a..b=3: the path 'a..b' has an empty part.");
  EXPECT_EQ(
      error_of("materials.density=3"),
      "--set materials.density=3: 'materials' does not exist at the top level. Did you mean 'material'? (A "
      "missing mapping can be set as a whole: --set 'materials={key: value}'.)");
  EXPECT_EQ(error_of("mesh.x=3"), "--set mesh.x=3: 'mesh' is a single value, so 'x' cannot be set below it.");
  EXPECT_EQ(
      error_of("probes.2.name=x"),
      "--set probes.2.name=x: 'probes' is a list of 2 entries; expected an entry number, counted from 0, "
      "instead of '2'.");
  EXPECT_EQ(
      error_of("damping={mass: 1, mass: 2}"),
      "--set damping={mass: 1, mass: 2}: damping.mass: this key appears twice (first at 1:2); remove one of "
      "the two.");
  EXPECT_EQ(error_of("mesh=[1"),
            "--set mesh=[1: the value is not valid YAML: a list opened with '[' before this position is not "
            "closed by ']'.");
}

TEST(Override, control_characters_are_refused_and_not_told) {
  for (const char* assignment : {"gravity=a\x1b[2J", "gra\x1bvity=1"}) try {
      read_with({assignment});
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("contains a control character"));
      EXPECT_THAT(error.what(), testing::HasSubstr("?"));
      EXPECT_EQ(std::string(error.what()).find('\x1b'), std::string::npos);
    }
}

TEST(Override, the_hash_covers_the_text_and_the_overrides) {
  config::Document a = document(), b = document();
  EXPECT_EQ(a.hash(), b.hash());
  b.set("mesh=b.msh");
  EXPECT_NE(a.hash(), b.hash());
  a.set("mesh=b.msh");
  EXPECT_EQ(a.hash(), b.hash());
  EXPECT_NE(document().hash(), config::Document::parse(good, "case.yaml").hash());
}

}  // namespace couplet::override_test
