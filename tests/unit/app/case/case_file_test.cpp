// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/case_file.hpp"

#include "common/config/document.hpp"
#include "tests/support/test.hpp"

namespace couplet::case_keys_test {
using namespace app;

using testing::ElementsAre;
using testing::IsEmpty;

const char* const text =
    "simulation: {end-time: 1 s, time-step: 20 ms}\n"
    "participants:\n"
    "  solid: {program: solid_solver, mesh: plate.msh, material: {density: 1000}, output: {stress: true}}\n";

std::string keys(const std::vector<std::string>& overrides = {},
                 const std::filesystem::path& folder = "/nowhere") {
  config::Document document = config::Document::parse(text, "case.yaml");
  for (const std::string& o : overrides) document.set(o);
  return case_keys(document, folder);
}

TEST(CaseKeys, the_same_case_has_no_changes_however_it_is_written) {
  const KeyChanges changes = changes_between(
      keys(), keys({"simulation.time-step=0.02 s", "participants.solid.material.density=1 g/cm^3"}));
  EXPECT_THAT(changes.harmless, IsEmpty());
  EXPECT_THAT(changes.physics, IsEmpty());
}

TEST(CaseKeys, times_and_outputs_are_harmless_and_the_rest_is_not) {
  const KeyChanges changes =
      changes_between(keys(), keys({"simulation.end-time=2 s", "participants.solid.output.stress=false",
                                    "participants.solid.material.density=2000",
                                    "participants.solid.body-force=[0, 1]", "participants.solid.mesh="}));
  EXPECT_THAT(changes.harmless, ElementsAre("participants.solid.output.stress: was true, is false",
                                            "simulation.end-time: was 1 s, is 2 s"));
  EXPECT_THAT(changes.physics, ElementsAre("participants.solid.material.density: was 1000, is 2000",
                                           "participants.solid.mesh: was plate.msh, is now absent",
                                           "participants.solid.body-force[0]: was absent, is now 0",
                                           "participants.solid.body-force[1]: was absent, is now 1"));
}

TEST(CaseKeys, another_content_of_a_file_is_a_change) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("couplet-keys-{}", ::getpid());
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "plate.msh") << "one";
  const std::string before = keys({}, folder);
  EXPECT_THAT(changes_between(before, keys({}, folder)).physics, IsEmpty());
  std::ofstream(folder / "plate.msh") << "two";
  EXPECT_THAT(changes_between(before, keys({}, folder)).physics,
              ElementsAre("participants.solid.mesh: content of plate.msh has changed"));
  std::filesystem::remove_all(folder);
}

TEST(CaseKeys, values_are_compared_as_quantities) {
  EXPECT_TRUE(config::same_value("20 ms", "0.02 s"));
  EXPECT_TRUE(config::same_value("20 ms", "0.02"));
  EXPECT_TRUE(config::same_value("0 degC", "273.15 K"));
  EXPECT_FALSE(config::same_value("20 ms", "0.02 m"));
  EXPECT_FALSE(config::same_value("20 ms", "20"));
  EXPECT_FALSE(config::same_value("fixed", "free"));
  EXPECT_FALSE(config::same_value("1.0000000001", "1"));
}

}  // namespace couplet::case_keys_test
