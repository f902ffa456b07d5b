// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/error_parts.hpp"
#include "common/diagnostics/results.hpp"
#include "tests/support/test.hpp"

namespace couplet::error_parts_test {
using namespace diagnostics;

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

TEST(ErrorPartsTest, errors_as_large_as_the_solution_prove_an_answer_useless_less_warns) {
  EXPECT_FALSE(worthless({{"solid", {.mesh = 0.1, .step = 0.04}}}).has_value());
  const auto some = worthless({{"solid", {.mesh = 0.1, .step = 0.06}}});
  ASSERT_TRUE(some.has_value());
  EXPECT_EQ(some->severity, base::Severity::warning);
  EXPECT_DOUBLE_EQ(some->limit, 0.15);
  const auto sum = worthless({{"solid", {.mesh = 0.6, .step = 0.5}}});
  ASSERT_TRUE(sum.has_value());
  EXPECT_EQ(sum->severity, base::Severity::wrong);
  EXPECT_EQ(worthless({{"fluid", {.mesh = 0.1}}, {"solid", {.mesh = 1.1, .step = 0.1}}})->severity,
            base::Severity::wrong);
}

TEST(ErrorPartsTest, the_next_change_lowers_the_largest_part) {
  const auto said = [](const ErrorParts& parts) { return best_change({{"solid", parts}}); };
  EXPECT_EQ(said({.mesh = 1e-2, .step = 5e-4, .linear = 5e-3}),
            "half the cell size (with 4 to 8 times the cells)");
  EXPECT_NE(said({.mesh = 1e-2, .step = 5e-4, .dimension = 2}).find("with 4 times the cells"),
            std::string::npos);
  EXPECT_EQ(said({.mesh = 1e-3, .step = 5e-2}), "half the time step (with twice the steps)");
  EXPECT_EQ(said({.mesh = 1e-2, .step = 5e-3, .dimension = 1}), "half the cell size (with twice the cells)");
  EXPECT_TRUE(error_sentences({{"solid", {}}}).empty());
}

// A run that leaves something out must not pass its discretisation's error for that of its answer; yet what the guards of
// the discretisation judge stays without it: neglected effects have findings of their own.
TEST(ErrorPartsTest, the_model_is_a_part_of_the_budget_and_proves_no_answer_useless) {
  const NamedErrors hot{
      "solid",
      {.mesh = 0.018, .model = 750, .model_by = "thermal strain neglected: use 'thermal-expansion'"}};
  const auto sentences = error_sentences({hot});
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_EQ(sentences[0], "estimated error 7.5e+02 of the solution: model 7.5e+02, mesh 0.018.");
  EXPECT_DOUBLE_EQ(total_error({hot}), 0.018);
  EXPECT_FALSE(worthless({hot}).has_value());
  const NamedErrors small{
      "solid", {.mesh = 0.018, .model = 1e-4, .omittable = "inertia (...) saves about 97 % of the time"}};
  const auto other = error_sentences({small});
  ASSERT_EQ(other.size(), 2u);
  EXPECT_EQ(other[1], "could be omitted: inertia (...) saves about 97 % of the time.");
}

TEST(ErrorPartsTest, words_and_dimension_are_read_again) {
  const ErrorParts parts{.mesh = 0.5, .model = 0.25, .model_by = "a | b", .omittable = "c", .dimension = 3};
  const ErrorParts again = ErrorParts::of(parts.text());
  EXPECT_EQ(again.mesh, 0.5);
  EXPECT_EQ(again.model, 0.25);
  EXPECT_EQ(again.model_by, "a | b");
  EXPECT_EQ(again.omittable, "c");
  EXPECT_EQ(again.dimension, 3);
}

TEST(ErrorPartsTest, of_a_job_the_largest_of_each_kind_counts_and_is_named) {
  const auto sentences = error_sentences({{"fluid", {.mesh = 1e-2, .step = 1e-3}},
                                          {"solid", {.mesh = 3e-3, .step = 4e-3}},
                                          {"coupling", {.coupling = 0.2}}});
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_EQ(
      sentences[0],
      "estimated error 0.21 of the solution: coupling tolerance 0.2 (coupling), mesh 0.01 (fluid), step 0.004 (solid).");
  const auto without = error_sentences({{"plate", {.step = 2e-9}}});
  EXPECT_EQ(without.at(0),
            "estimated error: the part due to the mesh is unknown; the rest is 2e-09 of the "
            "solution: step 2e-09.");
  // A verdict must not pass the tolerance of a solver for the error.
  const NamedErrors rounding{"sphere", {.linear = 9.4e-17}};
  EXPECT_EQ(error_summary({rounding}), "estimated error: unknown (the mesh)");
  EXPECT_NE(best_change({rounding}).find("half the cell size"), std::string::npos);
  EXPECT_EQ(error_summary({{"fluid", {.mesh = 1e-2, .step = 1e-3}}, rounding}),
            "estimated error: 1.1 % (mesh); unknown (the mesh)");
  const NamedErrors short_run{"solid", {.mesh = 1e-2, .misses_step = true}};
  EXPECT_EQ(error_summary({short_run}), "estimated error: 1 % plus an unknown part (the step)");
  EXPECT_NE(best_change({short_run}).find("half the time step"), std::string::npos);
  const ErrorParts flow{.mesh = 0.3, .step = 2e-2, .field = "velocity"},
      motion{.mesh = 2.5, .field = "displacement"};
  EXPECT_EQ(
      error_summary({short_run, {"fluid", flow}, {"flap", motion}}),
      "estimated error: unknown (the step); velocity of 'fluid' 32 % (mesh); displacement of 'flap' above 100 % (mesh)")
      << "a number that no estimator knows is not covered by one that knows another";
  EXPECT_EQ(ErrorParts::of(flow.text()).field, "velocity");
  EXPECT_TRUE(ErrorParts::of(short_run.parts.text()).misses_step);
}

TEST(ErrorPartsTest, results_have_the_error_of_their_field_and_of_no_other) {
  set_result({.name = "largest displacement", .unit = "m", .values = {2e-4}, .rank = 2});
  set_result({.name = "equivalent stress", .unit = "Pa", .values = {2.535e8}, .error = 0.02, .rank = 0});
  *results_of_table("probes", {"time [s]", "tip x [m]", "tip y [m]"}) = {1, 1.234e-4, 5e-20};
  *results_of_table("reactions", {"time [s]", "root x [N]", "root y [N]"}) = {1, 5600, 3e-14};
  std::string text;
  for (const Result& r : results({.mesh = 0.01, .field = "displacement", .unit = "m", .size = 3e-4}))
    text += r.name + ": " + r.text + "\n";
  EXPECT_EQ(text,
            "equivalent stress: 253.5 MPa +- 5.1 (2 %)\n"
            "tip: 123.4  0 um +- 3 (2.4 %)\n"
            "reaction root: 5.6  0 kN +- unknown\n"
            "largest displacement: 200 um +- 3 (1.5 %)\n")
      << "the error of a motion counts at its largest size";
}

}  // namespace couplet::error_parts_test
