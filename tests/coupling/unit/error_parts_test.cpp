// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/error_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/coupling/step_errors.hpp"

namespace couplet {
namespace {

TEST(StepErrorsTest, errors_of_an_oscillation_add_up) {
  StepErrors errors;
  const double dt = 0.1;
  for (int n = 1; n <= 1000; ++n)
    errors.add({1e-5, std::abs(std::cos(n * dt)), std::abs(std::sin(n * dt)), dt});
  EXPECT_NEAR(errors.over_size(), 1000 * 1e-5, 1e-3);
}

TEST(StepErrorsTest, on_the_way_to_a_steady_state_they_are_forgotten) {
  StepErrors errors;  // u = 1 - exp(-t), error of a step 1e-3 exp(-t)
  const double dt = 0.1;
  for (int n = 1; n <= 400; ++n)
    errors.add({1e-3 * std::exp(-n * dt), std::exp(-n * dt), 1 - std::exp(-n * dt), dt});
  EXPECT_LT(errors.over_size(), 1e-3);  // their plain sum is 1e-2
}

TEST(StepErrorsTest, of_a_decay_they_decay_as_it_does) {
  StepErrors errors;  // u = exp(-t), each step leaves 1e-4 u
  const double dt = 0.01;
  for (int n = 1; n <= 300; ++n)
    errors.add({1e-4 * std::exp(-n * dt), std::exp(-n * dt), std::exp(-n * dt), dt});
  // Exactly 300 * 1e-4 of u; sizes of late and rates by powers of two blur it.
  EXPECT_GT(errors.over_size(), 0.5 * 0.03);
  EXPECT_LT(errors.over_size(), 2 * 0.03);
}

TEST(StepErrorsTest, ringing_that_steps_do_not_resolve_errs_by_no_more_than_twice_itself) {
  // u = sin(t) + 0.001 sin(50 t): errors dt^3 / 12 d3u/dt3 of the ringing would add up to 1000 times its size.
  const double dt = 0.05, w = 50, a = 1e-3;
  StepErrors errors;
  for (int n = 1; n <= 2000; ++n) {
    const double t = n * dt, third = std::abs(std::cos(t) + a * w * w * w * std::cos(w * t));
    const double second = std::abs(std::sin(t) + a * w * w * std::sin(w * t));
    errors.add(
        {dt * dt * dt / 12 * third, std::abs(std::cos(t)), std::abs(std::sin(t)), dt, 2, second, third});
  }
  EXPECT_LT(errors.over_size(), 0.02);
  StepErrors alone;  // w = 1 alone: phase 100 dt^2 / 12 = 0.021, times the mean of |cos|
  for (int n = 1; n <= 2000; ++n) {
    const double t = n * dt, third = std::abs(std::cos(t));
    alone.add({dt * dt * dt / 12 * third, third, std::abs(std::sin(t)), dt, 2, std::abs(std::sin(t)), third});
  }
  EXPECT_NEAR(alone.over_size(), 0.0208 * 2 / M_PI, 2e-3);
}

TEST(StepErrorsTest, nothing_is_known_before_the_first_step) {
  EXPECT_TRUE(std::isnan(StepErrors().over_size()));
  StepErrors errors;
  errors.restore(std::vector<double>{});
  EXPECT_TRUE(std::isnan(errors.over_size()));
}

TEST(StepErrorsTest, a_restart_goes_on_bit_for_bit_and_a_damaged_state_is_refused) {
  StepErrors whole, first, second;
  for (int n = 1; n <= 20; ++n) {
    StepErrors& part = n <= 10 ? first : second;
    if (n == 11) second.restore(first.state());
    for (StepErrors* e : {&whole, &part}) e->add({1e-3 / n, 1. / n, 2, 0.1, 2, 3. / n, 8. / n});
  }
  EXPECT_EQ(whole.over_size(), second.over_size());
  EXPECT_EQ(whole.state(), second.state());
  EXPECT_THROW(second.restore(std::vector<double>{1, 2}), Error);
}

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

TEST(ErrorPartsTest, the_largest_part_dominates_and_what_is_a_tenth_of_it_buys_nothing) {
  const auto said = [](ErrorParts parts) {
    const auto sentences = error_sentences({{"solid", parts}});
    return sentences.size() > 1 ? sentences[1] : "";
  };
  EXPECT_EQ(said({.mesh = 1e-2, .step = 5e-4, .linear = 5e-3}),
            "the mesh dominates: a finer mesh would lower it; halving the step would buy nothing.");
  EXPECT_EQ(said({.mesh = 1e-3, .step = 5e-2}),
            "the step dominates: a shorter time step would lower it; refining the mesh would buy nothing.");
  EXPECT_EQ(said({.mesh = 1e-3, .step = 2e-3}), "the step dominates: a shorter time step would lower it.");
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
  EXPECT_EQ(sentences[1].rfind("the coupling tolerance (coupling) dominates", 0), 0u) << sentences[1];
}

}  // namespace
}  // namespace couplet
