// SPDX-License-Identifier: Apache-2.0
#include "common/config/missing_physics.hpp"

#include <regex>

#include "common/config/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::missing_physics_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(MissingPhysics, each_limit_is_a_row_of_the_limitations) {
  std::ifstream file(LIMITATIONS);
  std::ostringstream text;
  text << file.rdbuf();
  // Links become their texts, and code and quoted keys words.
  const auto unquoted = [](std::string_view s) {
    return std::regex_replace(std::string(s), std::regex("[`']"), "");
  };
  const std::string plain =
      unquoted(std::regex_replace(text.str(), std::regex(R"(\[([^\]]*)\]\([^)]*\))"), "$1"));
  for (const config::MissingPhysics& row : config::missing_physics()) {
    const std::size_t begin = plain.find("\n| " + unquoted(row.limit) + " |");
    ASSERT_NE(begin, std::string::npos) << row.limit;
    EXPECT_THAT(plain.substr(begin, plain.find('\n', begin + 1) - begin),
                HasSubstr("| " + unquoted(row.instead) + " |"));
  }
}

std::vector<std::string> errors_of(const std::string& program, const std::string& line) {
  const auto document = config::Document::parse(
      "participants:\n  p:\n    program: " + program + "\n    " + line + "\n", "case.yaml");
  std::string name, model = "wale";
  double viscosity = 1;
  return config::load(document, "participants.p", [&](config::Section& s) {
    s.value("program", name);
    s.value("viscosity", viscosity);
    s.variant("model", model, {{"wale", "wale", [](config::Section&) {}}}, "");
  });
}

TEST(MissingPhysics, a_key_or_value_that_asks_for_it_is_answered_with_the_limit) {
  const std::string rans =
      "This is a limit of Couplet: no wall functions; Smagorinsky and WALE need a mesh that resolves the wall; no RANS "
      "models. Instead: refine at the walls until y+ is about 1, or use another fluid solver (docs/limitations.md).";
  EXPECT_THAT(errors_of("fluid_solver", "model: k-omega-sst"),
              ElementsAre("case.yaml:4:5: participants.p.model: 'k-omega-sst' is not available. " + rans));
  EXPECT_THAT(errors_of("fluid_solver", "turbulence-model: kOmegaSST"),
              ElementsAre("case.yaml:4:5: participants.p.turbulence-model: unknown key. " + rans));
  for (const char* line : {"viscosity: {model: casson, zero: 1}", "viscosity: quemada", "oldroyd-b: {n: 0.5}",
                           "Viscoelastic: [1]"})
    EXPECT_THAT(errors_of("fluid_solver", line), ElementsAre(HasSubstr("no viscoelastic fluids. Instead:")))
        << line;
  EXPECT_THAT(errors_of("solid_solver", "material-law: {type: [elastic, plastic]}"),
              ElementsAre(HasSubstr("no plasticity")));
}

TEST(MissingPhysics, a_key_or_word_that_is_gone_is_answered_with_what_to_use) {
  EXPECT_THAT(
      errors_of("fluid_solver", "upstream-line: {length: 1}"),
      ElementsAre(
          "case.yaml:4:5: participants.p.upstream-line: unknown key. This key or value was removed (CHANGELOG.md). "
          "Instead: mesh the tube, or set 'upstream-volume'."));
  EXPECT_THAT(
      errors_of("fluid_solver", "model: runge-kutta"),
      ElementsAre(HasSubstr(
          "'runge-kutta' is not available. This key or value was removed (CHANGELOG.md). Instead: ")));
  EXPECT_THAT(errors_of("solid_solver", "upstream-line: 1"),
              ElementsAre(HasSubstr("unknown key. Valid keys: ")));
}

TEST(MissingPhysics, other_keys_and_programs_are_answered_as_before) {
  EXPECT_THAT(errors_of("solid_solver", "heat-capacity-ratio: 1.4"),
              ElementsAre(HasSubstr("unknown key. Valid keys: ")));
  EXPECT_THAT(errors_of("solid_solver", "casson: 1"), ElementsAre(HasSubstr("unknown key. Valid keys: ")));
  EXPECT_THAT(errors_of("fluid_solver", "viscosity: thick"),
              ElementsAre(HasSubstr("'thick' is not a number")));
}

}  // namespace couplet::missing_physics_test
