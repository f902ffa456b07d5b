// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test.hpp"

namespace couplet::collective_test {
using namespace parallel;

class Collective : public ::testing::Test {
 protected:
  const int size = comm_size(MPI_COMM_WORLD), rank = comm_rank(MPI_COMM_WORLD);
};

TEST_F(Collective, reductions_give_the_same_on_every_rank) {
  EXPECT_EQ(sum(MPI_COMM_WORLD, rank + 0.5), size * (size - 1) / 2.0 + 0.5 * size);
  EXPECT_EQ(sum(MPI_COMM_WORLD, GlobalIndex(1) << 40), GlobalIndex(size) << 40);
  EXPECT_EQ(max(MPI_COMM_WORLD, double(rank)), size - 1);
  EXPECT_EQ(min(MPI_COMM_WORLD, double(rank)), 0);
  EXPECT_TRUE(any(MPI_COMM_WORLD, rank == size - 1));
  EXPECT_FALSE(any(MPI_COMM_WORLD, false));
  EXPECT_EQ(exclusive_scan(MPI_COMM_WORLD, rank + 1), GlobalIndex(rank) * (rank + 1) / 2);
}

TEST_F(Collective, gathers_keep_the_order_of_the_ranks) {
  const std::vector<GlobalIndex> mine(rank + 1, rank);  // rank r gives r + 1 times r
  std::vector<GlobalIndex> expected;
  for (int r = 0; r < size; ++r) expected.insert(expected.end(), r + 1, r);
  EXPECT_EQ(all_gather(MPI_COMM_WORLD, mine), expected);
  EXPECT_EQ(gather(MPI_COMM_WORLD, mine), rank == 0 ? expected : std::vector<GlobalIndex>());
}

TEST_F(Collective, all_to_all_delivers_messages_of_unequal_length) {
  std::vector<std::vector<double>> send(size);
  for (int r = 0; r < size; ++r) send[r].assign((rank + 2 * r) % 3, 10 * rank + r);
  const auto received = all_to_all(MPI_COMM_WORLD, send);
  ASSERT_EQ(received.size(), std::size_t(size));
  for (int r = 0; r < size; ++r)
    EXPECT_EQ(received[r], std::vector<double>((r + 2 * rank) % 3, 10 * r + rank));
}

TEST_F(Collective, broadcast_text_of_any_length) {
  std::string text = rank == size - 1 ? "from the last rank" : "something longer that must go away";
  broadcast(MPI_COMM_WORLD, text, size - 1);
  EXPECT_EQ(text, "from the last rank");
  text = "";
  broadcast(MPI_COMM_WORLD, text);
  EXPECT_EQ(text, "");
}

}  // namespace couplet::collective_test
