// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/reference.hpp"

#include "common/base/numbers.hpp"
#include "tests/support/test.hpp"

namespace couplet::testing::reference_test {
using namespace diagnostics;

TEST(Reference, every_row_has_a_floor_and_only_those_compared_with_sums_over_the_run_keep_their_largest) {
  constexpr double rounding = 3e-12;
  for (const ReferenceEntry& row : references()) {
    Reference of(row.name);
    EXPECT_EQ(of.share(1, 0), 0) << row.name << ": nothing to compare with yet";
    of.add(1e-15, 0.01);
    EXPECT_EQ(of.share(-rounding, rounding), 0) << row.name;
    EXPECT_NEAR(of.share(2 * rounding, rounding), 2, 1e-12) << row.name;
    EXPECT_NEAR(of.share(1e-15, 0), 1, 1e-12) << row.name;
    EXPECT_TRUE(std::isnan(of.share(std::nan(""), rounding))) << row.name;
    // A blow-up that ended with a shorter step.
    for (int n = 0; n < 100; ++n) of.add(1, 0.01);
    of.add(1e6, 0.01);
    of.forget();
    for (int n = 0; n < 40; ++n) of.add(1, 0.005);
    EXPECT_EQ(of.value(), row.forgets ? 1 : 1e6) << row.name;
  }
}

TEST(Reference, without_a_rejected_step_it_is_the_largest_of_the_run) {
  Reference of("fluid: mean speed");
  for (int n = 1; n <= 1000; ++n) of.add(std::abs(std::sin(0.01 * n)) / n, 0.01);
  EXPECT_EQ(of.value(), std::sin(0.01));
}

TEST(Reference, goes_on_after_a_restart) {
  Reference of("fluid: mean speed");
  for (int n = 0; n < 7; ++n) of.add(7 - n, 0.1);
  of.forget();
  of.add(3, 0.05);
  Reference again("fluid: mean speed");
  base::from_numbers(base::to_numbers(of), again, "reference");
  of.add(0, 0.1), again.add(0, 0.1);
  EXPECT_EQ(again.value(), of.value());
}

TEST(Reference, a_name_without_a_row_is_refused) { EXPECT_THROW(Reference("speed"), std::logic_error); }

}  // namespace couplet::testing::reference_test
