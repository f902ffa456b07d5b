// SPDX-License-Identifier: Apache-2.0
#include "common/base/text.hpp"
#include "tests/support/test.hpp"

namespace couplet::text_test {
using namespace base;

TEST(Text, edit_distance_counts_insertions_deletions_replacements_and_swaps) {
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("density", "density"), 0u);
  EXPECT_EQ(edit_distance("density", "densty"), 1u);
  EXPECT_EQ(edit_distance("density", "dennsity"), 1u);
  EXPECT_EQ(edit_distance("density", "dansity"), 1u);
  EXPECT_EQ(edit_distance("density", "desnity"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(Text, the_nearest_word_is_suggested_only_if_it_is_near) {
  const std::vector<std::string> keys{"density", "youngs-modulus", "poisson-ratio"};
  EXPECT_EQ(closest("densty", keys), "density");
  EXPECT_EQ(closest("Density", keys), "density");
  EXPECT_EQ(closest("youngs_modulus", keys), "youngs-modulus");
  EXPECT_EQ(closest("modulus", keys), "youngs-modulus");
  EXPECT_EQ(closest("viscosity", keys), std::nullopt);
  EXPECT_EQ(did_you_mean("poison-ratio", keys, "keys"), "Did you mean 'poisson-ratio'?");
  EXPECT_EQ(did_you_mean("mesh", keys, "keys"), "Valid keys: density, youngs-modulus, poisson-ratio.");
  EXPECT_EQ(did_you_mean("mesh", {}, "patches"), "There are no patches here.");
}

TEST(Text, kebab_case_is_lower_case_words_with_single_hyphens) {
  for (const char* name : {"a", "end-time", "order-2"}) EXPECT_TRUE(is_kebab_case(name)) << name;
  for (const char* name : {"", "End", "end_time", "-a", "a-", "a--b", "a b"})
    EXPECT_FALSE(is_kebab_case(name)) << name;
}

TEST(Text, split_and_join_undo_each_other) {
  EXPECT_THAT(split("a.b..c", '.'), testing::ElementsAre("a", "b", "", "c"));
  EXPECT_EQ(join(split("a.b..c", '.'), "."), "a.b..c");
  EXPECT_THAT(split("", '.'), testing::ElementsAre(""));
  EXPECT_EQ(trim(" \t x y\n"), "x y");
  EXPECT_EQ(trim("  "), "");
}

TEST(Text, the_hash_is_that_of_the_published_algorithm) {
  // Test vectors of FNV-1a, 64 bit (Fowler, Noll, Vo).
  EXPECT_EQ(stable_hash(""), 0xcbf29ce484222325u);
  EXPECT_EQ(stable_hash("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(stable_hash("foobar"), 0x85944171f73967e8u);
}

}  // namespace couplet::text_test
