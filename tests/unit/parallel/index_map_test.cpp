// SPDX-License-Identifier: Apache-2.0
#include "common/parallel/index_map.hpp"
#include "tests/support/test.hpp"

namespace couplet::index_map_test {

/// A ring: rank r owns 2 + r entries and holds as ghosts the last of the rank before, then the first of the
/// rank after.
class Ring : public ::testing::Test {
 protected:
  const int size = parallel::comm_size(MPI_COMM_WORLD), rank = parallel::comm_rank(MPI_COMM_WORLD);
  const int before = (rank + size - 1) % size, after = (rank + 1) % size;
  const Index n_owned = 2 + rank;
  parallel::IndexMap map{MPI_COMM_WORLD, n_owned,
                         size > 1 ? std::vector<int>{before, after} : std::vector<int>{},
                         size > 1 ? std::vector<Index>{1 + before, 0} : std::vector<Index>{}};
  GlobalIndex first_of(int r) const { return 2 * r + r * (r - 1) / 2; }
};

TEST_F(Ring, owned_entries_are_numbered_rank_by_rank) {
  EXPECT_EQ(map.n_owned(), n_owned);
  EXPECT_EQ(map.n_ghost(), size > 1 ? 2 : 0);
  EXPECT_EQ(map.n_local(), map.n_owned() + map.n_ghost());
  EXPECT_EQ(map.n_global(), first_of(size));
  EXPECT_EQ(map.first(), first_of(rank));
  for (Index i = 0; i < n_owned; ++i) EXPECT_EQ(map.global(i), first_of(rank) + i);
}

TEST_F(Ring, ghosts_carry_the_global_numbers_of_their_owners) {
  if (size == 1) return;
  EXPECT_EQ(map.global(n_owned), first_of(before) + 1 + before);
  EXPECT_EQ(map.global(n_owned + 1), first_of(after));
}

TEST_F(Ring, update_overwrites_ghosts_with_all_components_of_their_owners) {
  std::vector<double> values(3 * std::size_t(map.n_local()), -1);
  for (Index i = 0; i < 3 * n_owned; ++i) values[i] = 100 * rank + i;
  const std::vector<double> owned(values.begin(), values.begin() + 3 * n_owned);
  map.update_ghosts(std::span<double>(values), 3);
  EXPECT_TRUE(std::equal(owned.begin(), owned.end(), values.begin())) << "owned entries stay";
  if (size == 1) return;
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(values[3 * n_owned + c], 100 * before + 3 * (1 + before) + c);
    EXPECT_EQ(values[3 * (n_owned + 1) + c], 100 * after + c);
  }
}

TEST_F(Ring, add_sums_the_ghosts_into_their_owners) {
  std::vector<double> values(map.n_local(), 1.0);
  for (Index i = n_owned; i < map.n_local(); ++i) values[i] = 10 * (rank + 1) + (i - n_owned);
  map.add_to_owners(std::span<double>(values));
  // The first entry is the second ghost of the rank before, the last entry the first ghost of the rank after.
  EXPECT_EQ(values[0], size > 1 ? 1 + 10 * (before + 1) + 1 : 1);
  EXPECT_EQ(values[n_owned - 1], size > 1 ? 1 + 10 * (after + 1) : 1);
  for (Index i = 1; i + 1 < n_owned; ++i) EXPECT_EQ(values[i], 1);
  if (size == 1) return;
  EXPECT_EQ(values[n_owned], 10 * (rank + 1)) << "ghosts stay";
}

}  // namespace couplet::index_map_test
