// SPDX-License-Identifier: Apache-2.0
#include <yaml-cpp/yaml.h>

#include "tests/unit/config/fixture.hpp"

namespace couplet::generated_test {
using testing::HasSubstr;
using testing::Not;

TEST(Effective, what_is_printed_reads_back_to_the_same_values) {
  Parameters p = read(good + R"(
load: '2*sin(t) # not a comment'
gravity: [0, -9.81]
patches: ['a: b', left]
divisions: {nx: 8, 'y-size': 2.5}
limit: 3 mm
damping: {mass: 0.1}
boundaries: {top: {type: inlet, velocity: [1, 2]}, '5': {type: wall}}
probes: [{name: 'yes', at: [1, 2, 3]}, {name: b}]
)");
  const std::string text = config::effective(declaration(p));
  Parameters again = read(text);
  EXPECT_EQ(config::effective(declaration(again)), text);
  EXPECT_EQ(again.load.text, "2*sin(t) # not a comment");
  EXPECT_THAT(again.patches, testing::ElementsAre("a: b", "left"));
  EXPECT_THAT(again.divisions, testing::ElementsAre(testing::Pair("nx", 8), testing::Pair("y-size", 2.5)));
  EXPECT_EQ(again.boundaries.at("top").velocity, Vec3(1, 2, 0));
  EXPECT_EQ(again.probes.at(0).name, "yes");
  EXPECT_THAT(text, HasSubstr("youngs-modulus: 5600000  # Pa\n"));
}

TEST(Effective, what_is_not_there_is_said_and_not_made) {
  Parameters p = read(good);
  const std::string text = config::effective(declaration(p));
  EXPECT_THAT(text, HasSubstr("# limit: not set\n"));
  EXPECT_THAT(text, HasSubstr("# damping: not there\n"));
  EXPECT_THAT(text, HasSubstr("boundaries: {}\n"));
  EXPECT_FALSE(p.damping.has_value());
  EXPECT_TRUE(p.boundaries.empty());
  EXPECT_TRUE(read(text).probes.empty());
}

TEST(Markdown, every_key_is_there_with_unit_default_range_and_meaning) {
  Parameters p;
  const std::string text = config::markdown("A program", declaration(p));
  for (const char* line :
       {"# A program\n", "| key | type | unit | default | allowed | meaning |\n",
        "| `mesh` | text |  | **required** |  | mesh file |\n",
        "| `analysis` | word |  | `dynamic` | `static`, `dynamic` | with or without inertia |\n",
        "| `interval` | number | `s` | `0` | at least 0 s | time between outputs |\n", "\n## `material`\n",
        "| `youngs-modulus` | number | `Pa` | **required** | above 0 Pa | Young's modulus |\n",
        "| `poisson-ratio` | number |  | `0.3` | from -1 to 0.5 | Poisson's ratio |\n",
        "| `damping` | mapping |  | not used |  | proportional damping |\n", "\n## `damping`\n",
        "| `limit` | number | `m` | not set | above 0 m |  |\n",
        "| `boundaries` | mapping by patch |  |  |  | one entry for each patch of the mesh |\n",
        "\n## `boundaries.<patch>`\n",
        "| `type` | word |  | **required** | `wall`, `inlet`, `outlet` | what the patch is |\n",
        "\n## `boundaries.<patch>` with `type: inlet`\n", "\n## `probes[]`\n"})
    EXPECT_THAT(text, HasSubstr(line));
  EXPECT_THAT(text, Not(HasSubstr("type: wall`")));
}

// JSON is YAML, so the parser at hand reads the schema.
TEST(Schema, says_what_the_reader_says) {
  Parameters p;
  const YAML::Node schema = YAML::Load(config::json_schema("A program", declaration(p)));
  EXPECT_EQ(schema["$schema"].as<std::string>(), "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(schema["title"].as<std::string>(), "A program");
  EXPECT_FALSE(schema["additionalProperties"].as<bool>());
  EXPECT_THAT(schema["required"].as<std::vector<std::string>>(), testing::ElementsAre("mesh", "material"));
  const YAML::Node keys = schema["properties"];
  EXPECT_THAT(keys["analysis"]["enum"].as<std::vector<std::string>>(),
              testing::ElementsAre("static", "dynamic"));
  EXPECT_EQ(keys["iterations"]["type"].as<std::string>(), "integer");
  EXPECT_EQ(keys["iterations"]["minimum"].as<int>(), 1);
  EXPECT_EQ(keys["iterations"]["maximum"].as<int>(), 1000);
  EXPECT_EQ(keys["gravity"]["minItems"].as<int>(), 2);
  const YAML::Node modulus = keys["material"]["properties"]["youngs-modulus"];
  EXPECT_EQ(modulus["description"].as<std::string>(), "Young's modulus [Pa] (above 0 Pa)");
  EXPECT_EQ(modulus["anyOf"][0]["exclusiveMinimum"].as<double>(), 0);
  EXPECT_EQ(modulus["anyOf"][1]["type"].as<std::string>(), "string");
  const YAML::Node boundary = keys["boundaries"]["additionalProperties"]["oneOf"];
  ASSERT_EQ(boundary.size(), 3u);
  EXPECT_EQ(boundary[1]["properties"]["type"]["const"].as<std::string>(), "inlet");
  EXPECT_THAT(boundary[1]["required"].as<std::vector<std::string>>(),
              testing::ElementsAre("type", "velocity"));
  EXPECT_FALSE(boundary[0]["properties"]["velocity"].IsDefined());
  EXPECT_FALSE(boundary[0]["additionalProperties"].as<bool>());
}

}  // namespace couplet::generated_test
