// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/partition.hpp"
#include "tests/support/test.hpp"

namespace couplet::partition_test {
using namespace mesh;

/// Graph of an nx x ny grid whose nodes are numbered at random.
Csr shuffled_grid(Index nx, Index ny) {
  std::vector<Index> number(nx * ny), first, second;
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), std::mt19937(5));
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i) {
      if (i + 1 < nx) {
        first.push_back(number[i + nx * j]);
        second.push_back(number[i + 1 + nx * j]);
      }
      if (j + 1 < ny) {
        first.push_back(number[i + nx * j]);
        second.push_back(number[i + nx * (j + 1)]);
      }
    }
  return make_graph(nx * ny, first, second);
}

std::vector<int> partition_alone(const Csr& graph, int parts) {
  const std::vector<GlobalIndex> neighbours(graph.index.begin(), graph.index.end());
  return partition(MPI_COMM_SELF, graph.offset, neighbours, parts);
}

TEST(ReverseCuthillMcKee, brings_the_bandwidth_of_a_grid_near_its_short_side) {
  const Csr graph = shuffled_grid(40, 6);
  const std::vector<Index> order = reverse_cuthill_mckee(graph);
  std::vector<Index> position(order.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) position[order[i]] = Index(i);
  Index bandwidth = 0;
  for (Index i = 0; i < graph.size(); ++i) {
    ASSERT_GE(position[i], 0) << "every node once";
    for (const Index n : graph[i]) bandwidth = std::max(bandwidth, std::abs(position[i] - position[n]));
  }
  EXPECT_LE(bandwidth, 8);
}

TEST(ReverseCuthillMcKee, takes_graphs_of_several_components) {
  const Csr graph = make_graph(5, std::vector<Index>{0}, std::vector<Index>{3});
  std::vector<Index> order = reverse_cuthill_mckee(graph);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, (std::vector<Index>{0, 1, 2, 3, 4}));
}

TEST(Partition, is_balanced_and_cuts_few_edges) {
  const Csr graph = shuffled_grid(40, 10);
  const std::vector<int> part = partition_alone(graph, 4);
  std::vector<int> count(4, 0);
  int cut = 0;
  for (Index i = 0; i < graph.size(); ++i) {
    ++count.at(part[i]);
    for (const Index n : graph[i]) cut += part[i] != part[n];
  }
  for (const int c : count) EXPECT_NEAR(c, 100, 12);
  EXPECT_LE(cut / 2, 60) << "strips would cut 30 edges, random parts about 560";
}

TEST(Partition, is_the_same_in_every_call) {
  const Csr graph = shuffled_grid(60, 50);
  const std::vector<int> first = partition_alone(graph, 3);
  EXPECT_EQ(partition_alone(graph, 3), first);
  partition_alone(shuffled_grid(17, 9), 2);  // whatever comes between
  EXPECT_EQ(partition_alone(graph, 3), first);
}

}  // namespace couplet::partition_test
