// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/config/fixture.hpp"

namespace couplet::load_test {
using testing::ElementsAre;

TEST(Load, keys_fill_the_members_in_si_units) {
  const Parameters p = read(R"(
mesh: plate.msh
analysis: static
material: {youngs-modulus: 5.6 MPa, poisson-ratio: 0.4}
interval: 2 min
temperature: 20 degC
relaxation: 25 %
iterations: 7
large: yes
load: 1.5 kPa
gravity: [0 m/s^2, -981 cm/s^2]
times: [0, 1 ms, 2.5]
patches: [left, right]
limit: 3 mm
damping: {mass: 4 1/s}
boundaries:
  left: {type: inlet, velocity: [1, 2, 3]}
  right: {type: outlet, pressure: 1 bar}
  wall: {type: wall}
probes:
  - {name: tip, at: [1 cm, 2 cm]}
  - {name: root}
)");
  EXPECT_EQ(p.mesh, "plate.msh");
  EXPECT_EQ(p.analysis, Parameters::Analysis::steady);
  EXPECT_DOUBLE_EQ(p.youngs_modulus, 5.6e6);
  EXPECT_DOUBLE_EQ(p.poisson_ratio, 0.4);
  EXPECT_DOUBLE_EQ(p.interval, 120);
  EXPECT_DOUBLE_EQ(p.temperature, 293.15);
  EXPECT_DOUBLE_EQ(p.relaxation, 0.25);
  EXPECT_EQ(p.iterations, 7);
  EXPECT_TRUE(p.large);
  EXPECT_EQ(p.load.text, "1500");
  EXPECT_EQ(p.gravity, Vec3(0, -9.81, 0));
  EXPECT_THAT(p.times, ElementsAre(0, 1e-3, 2.5));
  EXPECT_THAT(p.patches, ElementsAre("left", "right"));
  EXPECT_DOUBLE_EQ(p.limit.value(), 3e-3);
  EXPECT_DOUBLE_EQ(p.damping.value().mass, 4);
  ASSERT_EQ(p.boundaries.size(), 3u);
  EXPECT_EQ(p.boundaries.at("left").velocity, Vec3(1, 2, 3));
  EXPECT_DOUBLE_EQ(p.boundaries.at("right").pressure, 1e5);
  EXPECT_EQ(p.boundaries.at("wall").type, Boundary::Type::wall);
  ASSERT_EQ(p.probes.size(), 2u);
  EXPECT_EQ(p.probes[0].at, Vec3(0.01, 0.02, 0));
  EXPECT_EQ(p.probes[1].name, "root");
}

/// A number whose keys follow under the same name may be a mapping instead.
TEST(Load, a_number_may_be_a_mapping_where_a_section_of_its_name_is_declared_next) {
  struct Values {
    double viscosity = 0;
    std::optional<Damping> law;
    int other = 0;
  };
  const auto declaration_of = [](Values& v) {
    return [&v](config::Section& s) {
      s.value("viscosity", v.viscosity).required();
      s.optional_section<Damping>(
          "viscosity", v.law, [](config::Section& d, Damping& it) { d.value("mass", it.mass).unit("1/s"); },
          "");
      s.value("other", v.other).required();
    };
  };
  const auto read_law = [&](const std::string& text, Values& v) {
    return config::load(config::Document::parse(text, "case.yaml"), "", declaration_of(v));
  };
  Values number, law, wrong;
  EXPECT_THAT(read_law("viscosity: 3\nother: 1\n", number), ElementsAre());
  EXPECT_EQ(number.viscosity, 3);
  EXPECT_FALSE(number.law.has_value());
  EXPECT_THAT(config::effective(declaration_of(number)), "viscosity: 3\nother: 1\n");
  EXPECT_THAT(read_law("viscosity: {mass: 2}\nother: 1\n", law), ElementsAre());
  EXPECT_EQ(law.law.value().mass, 2);
  EXPECT_THAT(config::effective(declaration_of(law)), "viscosity:\n  mass: 2  # 1/s\nother: 1\n");
  EXPECT_THAT(read_law("viscosity: thick\nother: {mass: 2}\n", wrong),
              ElementsAre(testing::HasSubstr("case.yaml:1:1: viscosity: "),
                          testing::HasSubstr("case.yaml:2:1: other: ")));
  EXPECT_THAT(read_law("other: 1\n", wrong), ElementsAre(testing::HasSubstr("this required key is missing")));
  EXPECT_THAT(read_law("viscosity: {weight: 2}\nother: 1\n", wrong),
              ElementsAre(testing::HasSubstr("case.yaml:1:13: viscosity.weight: unknown key")));
  const std::string schema = config::json_schema("t", declaration_of(number));
  EXPECT_EQ(schema.find("\"viscosity\": {"), schema.rfind("\"viscosity\": {"));
}

TEST(Load, absent_keys_keep_the_defaults_and_absent_effects_do_not_exist) {
  const Parameters p = read(good);
  EXPECT_EQ(p.analysis, Parameters::Analysis::dynamic);
  EXPECT_DOUBLE_EQ(p.poisson_ratio, 0.3);
  EXPECT_FALSE(p.limit.has_value());
  EXPECT_FALSE(p.damping.has_value());
  EXPECT_TRUE(p.boundaries.empty());
  EXPECT_TRUE(p.probes.empty());
}

TEST(Load, expressions_stay_text_and_numbers_in_them_are_si) {
  EXPECT_EQ(read(good + "load: 2*sin(t)").load.text, "2*sin(t)");
  EXPECT_EQ(read(good + "load: 'x < 1 ? 5 : 0'").load.text, "x < 1 ? 5 : 0");
  EXPECT_EQ(read(good + "load: 2/t").load.text, "2/t");
  EXPECT_EQ(read(good + "load: 5 N/mm^2").load.text, "5000000");
  EXPECT_EQ(read(good + "load: -3").load.text, "-3");
}

TEST(Load, anchors_repeat_what_they_name) {
  const Parameters p = read(good + "boundaries: {left: &in {type: inlet, velocity: [1, 2]}, right: *in}");
  EXPECT_EQ(p.boundaries.at("right").velocity, Vec3(1, 2, 0));
}

TEST(Load, all_mistakes_of_a_file_come_at_once_and_in_file_order) {
  EXPECT_THAT(
      errors_of(
          "material:\n  youngs-modulus: -5\n  poison-ratio: 0.3\niterations: many\nanalysis: dynamics\n"),
      ElementsAre(
          "case.yaml:1:1: mesh: this required key is missing (mesh file: text).",
          "case.yaml:2:3: material.youngs-modulus: -5 Pa is out of range; expected a value above 0 Pa.",
          "case.yaml:3:3: material.poison-ratio: unknown key. Did you mean 'poisson-ratio'?",
          "case.yaml:4:1: iterations: 'many' is not a number; expected a plain number.",
          "case.yaml:5:1: analysis: 'dynamics' is not one of: static, dynamic. Did you mean 'dynamic'?"));
}

TEST(Load, a_section_can_be_read_by_its_path) {
  const auto document = config::Document::parse("participants:\n  solid:\n    mesh: a\n", "case.yaml");
  Parameters p;
  EXPECT_THAT(
      config::load(document, "participants.solid", declaration(p)),
      ElementsAre("case.yaml:2:3: participants.solid.material.youngs-modulus: this required key is missing "
                  "(Young's modulus: number in Pa)."));
  EXPECT_THAT(
      config::load(document, "participants.solit", declaration(p)),
      ElementsAre("case.yaml:1:1: participants.solit: this section is missing. Did you write 'solid'?"));
  EXPECT_THAT(config::load(document, "simulation", declaration(p)),
              ElementsAre("case.yaml:1:1: simulation: this section is missing."));
  EXPECT_THAT(config::load(config::Document::parse("", "case.yaml"), "simulation", declaration(p)),
              ElementsAre("case.yaml:1:1: this file is empty."));
  EXPECT_THAT(config::keys_of(document, "participants"), ElementsAre("solid"));
  EXPECT_TRUE(config::keys_of(document, "coupling").empty());
  EXPECT_EQ(config::text_of(document, "participants.solid.mesh"), "a");
  EXPECT_FALSE(config::text_of(document, "participants.solid").has_value());
  const auto list = config::Document::parse("exchange: {participants: [tank, wall]}\n", "case.yaml");
  EXPECT_THAT(config::texts_of(list, "exchange.participants"), ElementsAre("tank", "wall"));
  EXPECT_TRUE(config::texts_of(list, "exchange").empty());
}

TEST(Load, cross_rules_run_only_when_their_section_is_right) {
  EXPECT_THAT(errors_of("mesh: a\nmaterial: {youngs-modulus: 1, poisson-ratio: 0.5}"),
              ElementsAre("case.yaml:2:31: material.poisson-ratio: 0.5 needs a mixed formulation."));
  EXPECT_THAT(errors_of("mesh: a\nmaterial: {youngs-modulus: -1, poisson-ratio: 0.5}"), testing::SizeIs(1));
  // Here the rule would look at a value that is not the one in the file.
  EXPECT_THAT(errors_of("mesh: []\nmaterial: {youngs-modulus: 1, poisson-ratio: 0.5}"),
              ElementsAre("case.yaml:1:1: mesh: expected a text, found a list."));
}

TEST(Load, a_misspelt_required_key_is_one_mistake_not_two) {
  EXPECT_THAT(errors_of("mash: a\nmaterial: {youngs-modulus: 1}"),
              ElementsAre("case.yaml:1:1: mash: unknown key. Did you mean 'mesh'?"));
}

}  // namespace couplet::load_test
