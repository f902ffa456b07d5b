// SPDX-License-Identifier: Apache-2.0
#include "common/base/numbers.hpp"
#include "tests/support/test.hpp"

namespace couplet::saved_numbers_test {
using namespace base;

TEST(SavedNumbers, are_taken_in_order_and_none_is_left) {
  const std::vector<double> values{0.5, 2, 7, 8, 9};
  SavedNumbers saved(values, "sums");
  EXPECT_EQ(saved.real(), 0.5);
  const std::size_t n = saved.count_of(1);
  ASSERT_EQ(n, 2u);
  EXPECT_EQ(saved.next(n)[1], 8);
  std::vector<double> last(1);
  saved.fill(last);
  EXPECT_EQ(last[0], 9);
  EXPECT_EQ(saved.left(), 0u);
}

TEST(SavedNumbers, counts_that_are_none_or_more_than_follow_are_refused) {
  for (const double count : {-1., 0.5, 3., 1e18, double(NAN), double(INFINITY), -1e300}) {
    const std::vector<double> values{count, 1, 2};
    EXPECT_THROW(SavedNumbers(values, "sums").count_of(1), Error) << count;
  }
  const std::vector<double> two{2, 1, 2, 3};
  EXPECT_EQ(SavedNumbers(two, "sums").count_of(1), 2u);
  EXPECT_THROW(SavedNumbers(two, "sums").count_of(2), Error);
  EXPECT_THROW(SavedNumbers(two, "sums").next(5), Error);
  EXPECT_THROW(SavedNumbers({}, "sums").real(), Error);
  try {
    SavedNumbers({}, "step errors").real();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "The checkpoint's step errors are damaged. Use an earlier one.");
  }
}

}  // namespace couplet::saved_numbers_test
