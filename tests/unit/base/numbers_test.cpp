// SPDX-License-Identifier: Apache-2.0
#include "common/base/numbers.hpp"
#include "tests/support/test.hpp"

namespace couplet::numbers_test {
using namespace base;

TEST(Numbers, are_taken_in_order_and_none_is_left) {
  const std::vector<double> values{0.5, 2, 7, 8, 9};
  Numbers saved(values, "sums");
  double first = 0;
  std::vector<double> list, last(1);
  saved(first, list);
  saved.fill(last);
  saved.finish();
  EXPECT_EQ(first, 0.5);
  EXPECT_EQ(list, (std::vector<double>{7, 8}));
  EXPECT_EQ(last[0], 9);
}

TEST(Numbers, counts_that_are_none_or_more_than_follow_are_refused) {
  std::vector<double> list;
  for (const double count : {-1., 0.5, 3., 1e18, double(NAN), double(INFINITY), -1e300}) {
    const std::vector<double> values{count, 1, 2};
    EXPECT_THROW(from_numbers(values, list, "sums"), Error) << count;
  }
  const std::vector<double> two{2, 1, 2}, more{2, 1, 2, 3};
  from_numbers(two, list, "sums");
  EXPECT_EQ(list.size(), 2u);
  EXPECT_THROW(from_numbers(more, list, "sums"), Error) << "one is left";
  EXPECT_EQ(support::error_of([&] { from_numbers({}, list, "step errors"); }),
            "The checkpoint's step errors are damaged. Use an earlier one.");
}

}  // namespace couplet::numbers_test
