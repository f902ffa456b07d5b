// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/finding.hpp"

#include "common/base/text.hpp"
#include "tests/support/test.hpp"

namespace couplet::finding_test {
using namespace base;

using diagnostics::FindingId;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

// Findings are those of the process: this test is the only one that makes some.
TEST(Findings, count_by_severity_channel_and_consent) {
  EXPECT_EQ(diagnostics::count(Severity::note, true), 0);
  diagnostics::finding(1, {.id = "strain-energy", .severity = Severity::note, .sentence = "a"});
  diagnostics::finding(
      1, {.id = "compressibility", .number = 0.4, .limit = 0.3, .sentence = "b", .advice = "\"c\""});
  EXPECT_EQ(diagnostics::count(Severity::warning, false), 0)
      << "an opinion on a neglected effect is no doubt";
  EXPECT_EQ(diagnostics::count(Severity::warning, true), 1);
  EXPECT_EQ(diagnostics::doubts(), 1);
  diagnostics::finding(1, {.id = "energy-growth", .severity = Severity::wrong, .sentence = "d"});
  EXPECT_EQ(diagnostics::count(Severity::wrong, true), 1);
  EXPECT_EQ(diagnostics::count(Severity::warning, false), 1);
  EXPECT_THAT(
      diagnostics::findings_as_json(),
      HasSubstr(
          R"({"id": "compressibility", "severity": "warning", "number": 0.4, "limit": 0.3, )"
          R"("sentence": "b", "advice": "\"c\"", "neglected-effect": true, "share": null, "accepted": false})"));
  diagnostics::accept(Words{"energy-growth"});
  EXPECT_EQ(diagnostics::count(Severity::wrong, true), 0);
  EXPECT_EQ(diagnostics::findings().size(), 3u) << "an accepted finding is kept";
  EXPECT_THAT(diagnostics::findings_as_json(),
              HasSubstr(R"("neglected-effect": false, "share": null, "accepted": true)"));
  EXPECT_THROW(diagnostics::finding(1, {.id = "no-such-id", .sentence = ""}), std::logic_error);
}

TEST(Findings, ids_are_unique_words_with_a_meaning) {
  std::set<std::string> seen;
  for (const FindingId& f : diagnostics::finding_ids()) {
    EXPECT_TRUE(seen.insert(f.id).second) << f.id << " stands there twice";
    EXPECT_TRUE(is_kebab_case(f.id)) << f.id;
    EXPECT_NE(std::string(f.meaning), "") << f.id;
  }
}

TEST(Findings, an_unknown_id_is_refused_with_the_one_meant_and_all_allowed) {
  EXPECT_EQ(diagnostics::unknown_ids(Words{"strain-energy", "error-estimate"}), "");
  const std::string refusal = diagnostics::unknown_ids(Words{"strain-energy", "strain-enrgy"});
  EXPECT_THAT(refusal, HasSubstr("unknown finding 'strain-enrgy', did you mean 'strain-energy'?"));
  EXPECT_THAT(refusal, HasSubstr("Findings: error-estimate, "));
}

}  // namespace couplet::finding_test
