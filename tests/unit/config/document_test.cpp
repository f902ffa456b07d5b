// SPDX-License-Identifier: Apache-2.0
#include "common/base/text.hpp"
#include "tests/unit/config/fixture.hpp"

namespace couplet::errors_test {

struct Case {
  std::string yaml;     ///< put behind the valid lines 1 and 2
  std::string message;  ///< all there is
};

class WrongKey : public testing::TestWithParam<Case> {};

TEST_P(WrongKey, is_reported_with_place_and_what_was_expected) {
  EXPECT_THAT(errors_of(good + GetParam().yaml), testing::ElementsAre("case.yaml:" + GetParam().message));
}

const Case cases[] = {
    {"iteration: 5", "3:1: iteration: unknown key. Did you mean 'iterations'?"},
    {"Load: 5", "3:1: Load: unknown key. Did you mean 'load'?"},
    {"quantities: {drag: {}}",
     "3:1: quantities: unknown key. Quantities of this program (a force, a value at a probe, an extremum) belong to the section 'study: "
     "{quantities: ...}' of the case; 'couplet study CASE --quantities' estimates their errors from differences between coarser runs (docs/studies.md)."},
    {"density: 5",
     "3:1: density: unknown key. Valid keys: mesh, analysis, material, interval, temperature, relaxation, iterations, large, "
     "load, gravity, times, patches, divisions, limit, damping, boundaries, probes."},
    {"interval: -1 ms", "3:1: interval: -0.001 s is out of range; expected a value at least 0 s."},
    {"interval: 5 m",
     "3:1: interval: '5 m': the unit 'm' is not convertible to s. Expected s or a unit convertible to it."},
    {"interval: 5 sec",
     "3:1: interval: '5 sec': unknown unit 'sec'. Expected s or a unit convertible to it."},
    {"interval: often", "3:1: interval: 'often' is not a number; expected a number in s or with its unit."},
    {"interval:", "3:1: interval: this key has no value; expected a number in s or with its unit."},
    {"interval: [1]", "3:1: interval: expected a number in s or with its unit, found a list."},
    {"interval: {every: 1}", "3:1: interval: expected a number in s or with its unit, found a mapping."},
    {"temperature: -300 degC", "3:1: temperature: '-300 degC' is -26.85 K, below absolute zero."},
    {"relaxation: 1.5", "3:1: relaxation: 1.5 is out of range; expected a value from 0 to 1."},
    {"relaxation: 0.5 m",
     "3:1: relaxation: '0.5 m' contains more than a number ('m'); expected a plain number."},
    {"iterations: 2.5", "3:1: iterations: '2.5' is not a whole number."},
    {"iterations: 0", "3:1: iterations: 0 is out of range; expected a value from 1 to 1000."},
    {"iterations: 1e12", "3:1: iterations: '1e12' is out of range for this integer key."},
    {"large: maybe", "3:1: large: 'maybe' is not valid; expected true or false."},
    {"analysis: modal", "3:1: analysis: 'modal' is not one of: static, dynamic."},
    {"analysis: [static]", "3:1: analysis: expected one of: static, dynamic, found a list."},
    {"load: 5 m/s",
     "3:1: load: '5 m/s': the unit 'm/s' is not convertible to Pa. Expected Pa or a unit convertible to it."},
    {"load: [1]",
     "3:1: load: expected a number in Pa, with its unit, or an expression in x, y, z, t that yields Pa, found "
     "a list."},
    {"gravity: 9.81",
     "3:1: gravity: expected a list of 2 or 3 numbers in m/s^2 or with their units, found '9.81'."},
    {"gravity: [1]",
     "3:1: gravity: expected a list of 2 or 3 numbers in m/s^2 or with their units, found 1 of them."},
    {"gravity: [1, down]",
     "3:1: gravity: entry 2 of the list: 'down' is not a number; expected a number in m/s^2 or with its "
     "unit."},
    {"times: [1, -2]",
     "3:1: times: entry 2 of the list: -2 s is out of range; expected a value at least 0 s."},
    {"times: {a: 1}", "3:1: times: expected a list of numbers in s or with their units, found a mapping."},
    {"patches: left", "3:1: patches: expected a list of texts, found 'left'."},
    {"limit: 0", "3:1: limit: 0 m is out of range; expected a value above 0 m."},
    {"damping: {}", "3:1: damping.mass: this required key is missing (number in 1/s)."},
    {"damping:", "3:1: damping.mass: this required key is missing (number in 1/s)."},
    {"damping: " + std::string(100, 'x'), "3:1: damping: expected a mapping (keys with values), found '" +
                                              std::string(60, 'x') +
                                              "' and 40 characters more. Its keys: mass."},
    {"damping: 3", "3:1: damping: expected a mapping (keys with values), found '3'. Its keys: mass."},
    {"boundaries: [left]",
     "3:1: boundaries: expected a mapping with one entry for each patch, found a list."},
    {"boundaries: {left: {velocity: [1, 2]}}",
     "3:14: boundaries.left.type: this required key is missing (one of: wall, inlet, "
     "outlet)."},
    {"boundaries: {left: {type: inlt, velocity: [1, 2]}}",
     "3:21: boundaries.left.type: 'inlt' is not one of: wall, inlet, outlet. Did you mean 'inlet'?"},
    {"boundaries:\n  left: {type: inlet}",
     "4:3: boundaries.left.velocity: this required key is missing (velocity of what flows in: list of 2 or 3 "
     "numbers in "
     "m/s)."},
    {"boundaries:\n  left: {type: wall, pressure: 3}",
     "4:22: boundaries.left.pressure: this key is not valid here; it requires type: outlet."},
    {"boundaries: {left: wall}",
     "3:14: boundaries.left: expected a mapping (keys with values), found 'wall'. Its keys: type, velocity, pressure."},
    {"probes: {name: tip}", "3:1: probes: expected a list of mappings, found a mapping."},
    {"probes:\n  - {name: tip}\n  - {at: [0, 0]}",
     "5:5: probes[1].name: this required key is missing (text)."},
    {"probes: [tip]",
     "3:10: probes[0]: expected a mapping (keys with values), found 'tip'. Its keys: name, at."},
    {"probes: [{name: tip, where: [0, 0]}]", "3:22: probes[0].where: unknown key. Valid keys: name, at."},
};
INSTANTIATE_TEST_SUITE_P(Config, WrongKey, testing::ValuesIn(cases),
                         [](const auto& info) { return std::to_string(info.index); });

std::string parse_error(const std::string& text) {
  return support::error_of([&] { config::Document::parse(text, "case.yaml"); });
}

TEST(WrongFile, duplicate_keys_are_refused_with_both_places_at_any_depth) {
  EXPECT_EQ(parse_error("a: 1\nb: 2\na: 3\n"),
            "case.yaml:3:1: a: this key appears twice (first at 1:1); remove one of the two.");
  EXPECT_EQ(parse_error("l:\n  - x: {k: 1, k: 2}\n  - y: {k: 1}\nl: 4\n"),
            "case.yaml:2:15: l[0].x.k: this key appears twice (first at 2:9); remove one of the two.\n"
            "case.yaml:4:1: l: this key appears twice (first at 1:1); remove one of the two.");
  EXPECT_EQ(parse_error("a: &x {k: 1}\nb: *x\n"), "");
}

TEST(WrongFile, broken_yaml_is_refused_with_its_place) {
  EXPECT_EQ(
      parse_error("a: [1, 2\nb: 3\n"),
      "case.yaml:2:2: this is not valid YAML: a list opened with '[' before this position is not closed by "
      "']'.");
  EXPECT_EQ(
      parse_error("a: {b: 3\n"),
      "case.yaml:2:1: this is not valid YAML: a mapping opened with '{' before this position is not closed "
      "by '}'.");
  EXPECT_EQ(
      parse_error("a: [1, 2}\n"),
      "case.yaml:1:9: this is not valid YAML: this bracket closes nothing; check '[', ']', '{' and '}'.");
  EXPECT_EQ(parse_error("a:\n\tb: 3\n"),
            "case.yaml:2:3: this is not valid YAML: tabs cannot be used for indentation; use spaces.");
  EXPECT_EQ(
      parse_error("a: b: 3\n"),
      "case.yaml:1:5: this is not valid YAML: a ':' is not allowed here; check the indentation above, and "
      "quote text that contains ': '.");
  EXPECT_EQ(parse_error("a:\n  - 1\n b: 2\n"),
            "case.yaml:3:2: this is not valid YAML: this line does not match the mapping above; check its "
            "indentation and its ':'.");
  const std::string second =
      "case.yaml:2:1: this line does not belong to the mapping above; check its indentation (and remove "
      "'---').";
  EXPECT_EQ(parse_error(" a: 1\nb: 2\n"), second);
  EXPECT_EQ(parse_error("a: 1\n---\nb: 2\n"), second);
  EXPECT_EQ(
      parse_error("a: *nowhere\n"),
      "case.yaml:1:4: this is not valid YAML: this '*name' refers to an anchor '&name' that does not exist.");
  EXPECT_EQ(parse_error(",a: 1\n"), "case.yaml:1:1" + second.substr(13));
  EXPECT_EQ(parse_error("a: &x {b: *x}\n").substr(0, 20), "case.yaml:1:1: a.b.b");
  EXPECT_EQ(parse_error("? [1, 2]\n: 3\n"), "case.yaml:1:3: a key must be a single word.");
}

TEST(WrongFile, a_file_that_cannot_be_read_is_named) {
  const auto error_of = [](const std::filesystem::path& file) {
    return support::error_of([&] { config::Document::read(file); });
  };
  EXPECT_EQ(error_of("no/such.yaml"),
            "no/such.yaml: this file does not exist. Give the path of the case's YAML file.");
  EXPECT_EQ(error_of("/proc"),
            "/proc: this is a folder; give the YAML file in it, for example /proc/case.yaml.");
}

TEST(WrongFile, something_else_than_a_mapping_is_refused) {
  EXPECT_THAT(errors_of(""), testing::ElementsAre("case.yaml:1:1: this file is empty."));
  EXPECT_THAT(errors_of("# nothing\n"), testing::ElementsAre("case.yaml:1:1: this file is empty."));
  EXPECT_THAT(errors_of("- a\n"),
              testing::ElementsAre("case.yaml:1:1: expected a mapping (keys with values), found a list."));
  EXPECT_THAT(errors_of("hello\n"),
              testing::ElementsAre("case.yaml:1:1: expected a mapping (keys with values), found 'hello'."));
}

TEST(WrongDeclaration, names_that_are_not_kebab_case_are_a_bug_at_once) {
  double x = 0;
  const auto document = config::Document::parse("a: 1", "case.yaml");
  EXPECT_THROW(config::load(document, "", [&](config::Section& s) { s.value("endTime", x); }),
               std::logic_error);
  EXPECT_THROW(config::load(document, "",
                            [&](config::Section& s) {
                              s.section(
                                  "a_b", [](config::Section&) {}, "");
                            }),
               std::logic_error);
}

}  // namespace couplet::errors_test
