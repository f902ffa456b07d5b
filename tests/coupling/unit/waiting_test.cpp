// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace couplet::coupler::waiting_test {
namespace {

using testing::HasSubstr;

std::vector<Worker> workers(double fluid, double solid, int fluid_ranks = 1, int solid_ranks = 1) {
  return {{"fluid", fluid_ranks, fluid}, {"solid", solid_ranks, solid}};
}

TEST(DivideRanks, is_as_quick_as_the_best_of_all_divisions) {
  const std::vector<Worker> three{{"fluid", 1, 90}, {"solid", 1, 9}, {"mover", 1, 20}};
  for (const bool side_by_side : {false, true})
    for (int total = 3; total <= 24; ++total) {
      const auto time = [&](int a, int b, int c) {
        const double t[] = {90. / a, 9. / b, 20. / c};
        return side_by_side ? std::max({t[0], t[1], t[2]}) : t[0] + t[1] + t[2];
      };
      double best = std::numeric_limits<double>::infinity();
      for (int a = 1; a <= total - 2; ++a)
        for (int b = 1; a + b < total; ++b) best = std::min(best, time(a, b, total - a - b));
      const std::vector<int> found = divide_ranks(three, total, side_by_side);
      EXPECT_EQ(found[0] + found[1] + found[2], total);
      EXPECT_NEAR(time(found[0], found[1], found[2]), best, 1e-12) << total << ' ' << side_by_side;
    }
}

TEST(Waiting, names_who_is_waited_for_and_whose_the_next_rank_should_be) {
  EXPECT_EQ(
      waiting_sentence(workers(9, 1), false),
      "waiting: one after another, the others wait for 'fluid' 90 % of the time at work; a further rank is best given to it "
      "('-n fluid=2')");
  EXPECT_THAT(waiting_sentence(workers(1, 9), true), HasSubstr("side by side, all wait for 'solid'"));
}

TEST(Waiting, proposes_a_division_only_where_it_gains_a_tenth) {
  // 9 s on two ranks and 1 s on two: three and one take 18/3 + 2/1 = 8 s for 10 s.
  EXPECT_THAT(waiting_sentence(workers(9, 1, 2, 2), false),
              HasSubstr("'-n fluid=3,solid=1' in place of fluid=2,solid=2 would take 20 % less"));
  EXPECT_THAT(waiting_sentence(workers(6, 2, 3, 1), false), HasSubstr("the ranks fit (fluid=3,solid=1)"));
}

TEST(Waiting, is_silent_about_one_participant_and_short_runs) {
  EXPECT_EQ(waiting_sentence({{"fluid", 4, 100}}, false), "");
  EXPECT_EQ(waiting_sentence(workers(0.5, 0.1), false), "");
}

}  // namespace
}  // namespace couplet::coupler::waiting_test
