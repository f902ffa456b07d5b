// SPDX-License-Identifier: Apache-2.0
// Prints a number that stands for the partition of a grid large enough for Scotch to use its threads.
#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <vector>

#include "common/mesh/partition.hpp"

int main(int argc, char** argv) {
  using couplet::Index;
  MPI_Init(&argc, &argv);
  {
    constexpr Index n = 40;
    std::vector<Index> first, second;
    const auto at = [](Index i, Index j, Index k) { return i + n * (j + n * k); };
    for (Index k = 0; k < n; ++k)
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i + 1 < n; ++i) {
          // The roles of i, j, k turn: edges along x, y and z.
          first.insert(first.end(), {at(i, j, k), at(k, i, j), at(j, k, i)});
          second.insert(second.end(), {at(i + 1, j, k), at(k, i + 1, j), at(j, k, i + 1)});
        }
    std::uint64_t hash = 0;
    const couplet::mesh::Csr graph = couplet::mesh::make_graph(n * n * n, first, second);
    const std::vector<couplet::GlobalIndex> neighbours(graph.index.begin(), graph.index.end());
    for (const int part : couplet::mesh::partition(MPI_COMM_SELF, graph.offset, neighbours, 3))
      hash = hash * 31 + static_cast<std::uint64_t>(part);
    std::printf("%llu\n", static_cast<unsigned long long>(hash));
  }
  MPI_Finalize();
}
