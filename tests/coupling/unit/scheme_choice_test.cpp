// SPDX-License-Identifier: Apache-2.0
#include "coupler/parameters/schedule.hpp"

#include <gtest/gtest.h>

namespace couplet::coupler::scheme_choice_test {
namespace {

using coupling::Scheme;

/// A step with so many renewals: whether the scheme has changed.
bool step(SchemeChoice& choice, int renewals) {
  choice.start_step();
  for (int i = 0; i < renewals; ++i) choice.renewed();
  return choice.accepted(1);
}

TEST(SchemeChoice, becomes_implicit_after_as_many_renewed_steps_in_a_row_as_it_says_and_once) {
  SchemeChoice choice{{}};
  for (int n = 1; n < SchemeChoice::most_in_a_row; ++n) EXPECT_FALSE(step(choice, SchemeChoice::too_many));
  EXPECT_EQ(choice.now(), Scheme::semi_implicit);
  EXPECT_TRUE(step(choice, SchemeChoice::too_many));
  EXPECT_EQ(choice.now(), Scheme::implicit);
  EXPECT_FALSE(step(choice, 0));
  EXPECT_EQ(choice.now(), Scheme::implicit);
}

TEST(SchemeChoice, stays_where_steps_with_few_renewals_lie_between) {
  SchemeChoice choice{{}};
  for (int n = 0; n < 20; ++n)
    EXPECT_FALSE(step(
        choice, n % SchemeChoice::most_in_a_row == 0 ? SchemeChoice::too_many - 1 : SchemeChoice::too_many));
  EXPECT_EQ(choice.now(), Scheme::semi_implicit);
}

TEST(SchemeChoice, becomes_implicit_where_half_of_the_steps_are_renewed_and_not_where_a_third_is) {
  SchemeChoice often{{}}, seldom{{}};
  int change = 0;
  for (int n = 1; n <= 400; ++n) {
    if (step(often, n % 2)) change = n;
    EXPECT_FALSE(step(seldom, n % 3 == 0 ? 2 : 0));
  }
  EXPECT_GT(change, 60);
  EXPECT_LT(change, 120);
  EXPECT_EQ(often.now(), Scheme::implicit);
}

TEST(SchemeChoice, a_scheme_that_was_asked_for_stays) {
  for (const Scheme asked : {Scheme::explicit_, Scheme::semi_implicit, Scheme::implicit}) {
    SchemeChoice choice{asked};
    for (int n = 0; n < 20; ++n) EXPECT_FALSE(step(choice, 9));
    EXPECT_FALSE(choice.failed());
    EXPECT_EQ(choice.now(), asked);
  }
}

TEST(SchemeChoice, a_failed_step_is_tried_once_as_an_implicit_one_until_withdrawn) {
  SchemeChoice choice{{}};
  EXPECT_TRUE(choice.failed());
  EXPECT_EQ(choice.now(), Scheme::implicit);
  EXPECT_FALSE(choice.failed());
  choice.withdraw();
  EXPECT_EQ(choice.now(), Scheme::semi_implicit);
  EXPECT_TRUE(choice.failed());
}

TEST(SchemeChoice, continues_from_a_checkpoint_with_its_count_or_its_change) {
  SchemeChoice choice{{}};
  step(choice, 4), step(choice, 4);
  SchemeChoice again{{}};
  again.restore(choice.state());
  for (int n = 3; n < SchemeChoice::most_in_a_row; ++n) EXPECT_FALSE(step(again, 4));
  EXPECT_TRUE(step(again, 4));
  SchemeChoice after{{}};
  after.restore(again.state());
  EXPECT_EQ(after.now(), Scheme::implicit);
  SchemeChoice fixed{Scheme::semi_implicit};
  fixed.restore(again.state());
  EXPECT_EQ(fixed.now(), Scheme::semi_implicit) << "the key of the run that continues decides";
}

}  // namespace
}  // namespace couplet::coupler::scheme_choice_test
