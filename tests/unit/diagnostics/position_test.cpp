// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/choices.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "tests/support/test.hpp"

namespace couplet::diagnostics::position_test {

TEST(Position, is_told_in_one_line_with_the_nearest_limit_and_its_map) {
  EXPECT_EQ(position_sentence({}), "");
  EXPECT_EQ(
      position_sentence({{"Courant number", 0.8, 1, "fluid-convection"},
                         {"added mass over mass", 0.4, 1.2, "coupling-mass"}}),
      "stability: Courant number 0.8 (limit 1), added mass over mass 0.4 (limit 1.2): within the tested range "
      "(docs/stability.md, fluid-convection).");
  EXPECT_EQ(
      position_sentence({{"least scaled Jacobian", -0.5, 0, "mover-rotation", true}}),
      "stability: least scaled Jacobian -0.5 (at least 0): beyond the tested range (docs/stability.md, mover-rotation).");
}

TEST(Position, of_a_run_is_the_nearest_to_each_limit_that_it_has_been) {
  std::vector<Coordinate> kept;
  keep_nearest(kept, {{"Courant number", 0.8, 1, "a"}});
  keep_nearest(kept, {{"Courant number", 0.7, 0.7, "a"}, {"least scaled Jacobian", 0.3, 0, "b", true}});
  keep_nearest(kept, {{"Courant number", 0.9, 1, "a"}, {"least scaled Jacobian", 0.6, 0, "b", true}});
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].value, 0.7);
  EXPECT_EQ(kept[1].value, 0.3);
}

}  // namespace couplet::diagnostics::position_test
