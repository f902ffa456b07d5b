// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/error_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.hpp"

namespace couplet {
namespace {

TEST(ErrorPartsTest, its_text_is_read_again) {
  const ErrorParts parts{.mesh = 0.0125, .linear = 3e-9};
  EXPECT_EQ(parts.text(), "mesh 0.0125 linear 3e-09");
  const ErrorParts again = ErrorParts::of(parts.text());
  EXPECT_EQ(again.mesh, 0.0125);
  EXPECT_EQ(again.linear, 3e-9);
  EXPECT_TRUE(std::isnan(again.step) && std::isnan(again.coupling));
  EXPECT_FALSE(ErrorParts::of("").known());
  EXPECT_THROW(ErrorParts::of("done"), Error);
  EXPECT_THROW(ErrorParts::of("mesh much"), Error);
}

TEST(ErrorPartsTest, one_part_as_large_as_the_solution_proves_an_answer_useless_a_sum_of_parts_warns) {
  EXPECT_FALSE(worthless({{"solid", {.mesh = 0.6, .step = 0.3}}}).has_value());
  const auto sum = worthless({{"solid", {.mesh = 0.6, .step = 0.5}}});
  ASSERT_TRUE(sum.has_value());
  EXPECT_EQ(sum->severity, Severity::warning);
  EXPECT_EQ(worthless({{"fluid", {.mesh = 0.1}}, {"solid", {.mesh = 1.1, .step = 0.1}}})->severity,
            Severity::wrong);
}

TEST(ErrorPartsTest, the_largest_part_dominates_and_what_is_a_tenth_of_it_buys_nothing) {
  const auto said = [](ErrorParts parts) {
    const auto sentences = error_sentences({{"solid", parts}});
    return sentences.size() > 1 ? sentences[1] : "";
  };
  EXPECT_EQ(said({.mesh = 1e-2, .step = 5e-4, .linear = 5e-3}),
            "the mesh dominates: a finer mesh would reduce it; halving the step would not help.");
  EXPECT_EQ(said({.mesh = 1e-3, .step = 5e-2}),
            "the step dominates: a shorter time step would reduce it; refining the mesh would not help.");
  EXPECT_EQ(said({.mesh = 1e-3, .step = 2e-3}), "the step dominates: a shorter time step would reduce it.");
  EXPECT_EQ(said({.mesh = 1e-2}), "");  // one part alone says nothing of the others
  EXPECT_TRUE(error_sentences({{"solid", {}}}).empty());
}

TEST(ErrorPartsTest, of_a_job_the_largest_of_each_kind_counts_and_is_named) {
  const auto sentences = error_sentences({{"fluid", {.mesh = 1e-2, .step = 1e-3}},
                                          {"solid", {.mesh = 3e-3, .step = 4e-3}},
                                          {"coupling", {.coupling = 0.2}}});
  ASSERT_EQ(sentences.size(), 2u);
  EXPECT_EQ(
      sentences[0],
      "estimated error 0.21 of the solution: coupling tolerance 0.2 (coupling), mesh 0.01 (fluid), step 0.004 (solid).");
  const auto without = error_sentences({{"plate", {.step = 2e-9}}});
  EXPECT_EQ(
      without.at(0),
      "estimated error 2e-09 of the solution: step 2e-09; the error due to the mesh (or truncated modes) is "
      "unknown and not included.");
  EXPECT_EQ(sentences[1].rfind("the coupling tolerance (coupling) dominates", 0), 0u) << sentences[1];
}

}  // namespace
}  // namespace couplet
